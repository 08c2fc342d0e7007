//! From models to scenes: glTF 2.0 and OBJ import, cameras, MIP pyramids and the demo scenes.
//!
//! What comes out is a [`Scene`]: objects, frames, and one sentence for everything that was left out. A model's other
//! files are read through [`Files`], so that the same importer runs where there is no file system.

mod camera;
mod demo;
mod error;
mod files;
mod gltf;
mod model;
mod normals;
mod obj;
mod picture;
pub mod pyramid;
mod tangents;
mod textures;
mod view;

pub use camera::{read_camera, write_camera};
pub use demo::{DEMOS, DemoInfo, demo};
pub use error::SceneError;
pub use files::{Directory, Files, MAX_FILE_BYTES, Memory};
pub use view::ViewOptions;

use basrelief_signals::Scene;
use error::Warnings;
use model::Model;
use std::path::Path;
use view::ViewHints;

/// Imports a model: GLB and glTF are told by their content, OBJ by the ending of its name.
///
/// `name` is the file's name, for messages and as the scene's name; `files` gives what the model refers to.
///
/// # Errors
/// Neither of the formats, corrupt, a required extension that is not supported, over a limit, or nothing to draw.
pub fn load(bytes: &[u8], name: &str, files: &dyn Files, options: &ViewOptions) -> Result<Scene, SceneError> {
    let mut warnings = Warnings::default();
    let model = import(bytes, name, files, &mut warnings).map_err(|e| e.in_file(name))?;
    let frames = ViewHints::still(model.bounds, model.camera, model.lamps).frames(options)?;
    Ok(Scene { name: name.into(), objects: model.objects, frames, warnings: warnings.into_vec() })
}

/// Imports a model from the file system; what it refers to is looked for in its folder.
///
/// # Errors
/// As [`load`], and where the file cannot be read.
pub fn load_path(path: &Path, options: &ViewOptions) -> Result<Scene, SceneError> {
    let shown = path.display().to_string();
    let bytes = files::read_regular(path)
        .map_err(|e| SceneError::at("", format!("cannot be read: {e}")).expected("a .glb, .gltf or .obj file").in_file(&shown))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    load(&bytes, &shown, &Directory::new(folder), options)
}

fn import(bytes: &[u8], name: &str, files: &dyn Files, warnings: &mut Warnings) -> Result<Model, SceneError> {
    let ending = name.rsplit('.').next().unwrap_or("").to_ascii_lowercase();
    let first = bytes.iter().find(|b| !b.is_ascii_whitespace());
    if bytes.starts_with(gltf::glb::MAGIC) || ending == "glb" {
        gltf::import_glb(bytes, files, warnings)
    } else if ending == "gltf" || (ending != "obj" && first == Some(&b'{')) {
        gltf::import_json(bytes, files, warnings)
    } else if ending == "obj" {
        obj::import(bytes, files, warnings)
    } else {
        Err(SceneError::at("", "no known model format")
            .expected("a .glb, .gltf or .obj file")
            .cure("convert the model to one of these"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_format_is_refused() {
        let error = load(b"solid x", "x.stl", &Memory::default(), &ViewOptions::default()).unwrap_err().to_string();
        assert!(error.starts_with("x.stl: no known model format; expected a .glb, .gltf or .obj file"), "{error}");
    }
}
