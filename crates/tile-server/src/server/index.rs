//! The page at `/served`: a list of the pictures and the commands to view the scene.

use crate::protocol::{hash_of_picture, hex};
use basrelief_scene::SceneSubject;
use basrelief_signals::Texture;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::Arc;

/// Returns the page. It uses no scripts and no external resources, and links to the viewer or names the command that builds it.
pub fn index_page(subject: &SceneSubject, textures: &[Arc<Texture>], has_viewer: bool) -> String {
    let name = escaped(subject.name());
    let pictures: BTreeMap<String, &Arc<Texture>> = textures.iter().map(|t| (hex(&hash_of_picture(t)), t)).collect();
    let mut rows = String::new();
    for (hash, texture) in &pictures {
        let [width, height] = texture.levels.first().map_or([1; 2], |image| [image.width, image.height]);
        // Writing to a string cannot fail.
        let _ = writeln!(
            rows,
            "<tr><td><img src=\"tile/{hash}/64x64/png/0\" alt=\"\"></td><td>{}</td><td>{width} x {height}</td><td><code>{hash}</code></td></tr>",
            escaped(&texture.name)
        );
    }
    let viewer = if has_viewer {
        "Or in this browser: <a href=\"./\">the viewer</a>."
    } else {
        "In this browser it can be looked at when the viewer is built: <code>web/build</code>."
    };
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{name}</title>\n\
         <style>body {{ font-family: sans-serif; margin: 2em }} td {{ padding: 0 1em 0 0 }} img {{ max-height: 4em }}</style></head><body>\n\
         <h1>{name}</h1>\n\
         <p>{} objects, {} triangles, {} pictures, served without a view by <code>basrelief serve</code>. To look at it:</p>\n\
         <pre>basrelief run --from http://ADDRESS:PORT/ --size 640x480 --turn 30,10 --set defer.mode=progressive --out out</pre>\n<p>{viewer}</p>\n\
         <p><code>/scene</code> is the scene without texels, <code>/tile/PICTURE/WIDTHxHEIGHT/ENCODING/NUMBER</code> a tile: the picture's \
         hash, the size of its tiles, <code>raw</code>, <code>png</code> or <code>jpeg-QUALITY</code>, and its number, from the top layer \
         down; several numbers with commas between give several tiles. What is at such an address never changes.</p>\n\
         <table>\n{rows}</table>\n</body></html>\n",
        subject.objects().len(),
        subject.triangles(),
        pictures.len()
    )
}

/// Escapes text for HTML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
