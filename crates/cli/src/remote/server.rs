//! `basrelief serve`: the server (110) as a program.

use super::Site;
use super::http::{Answer, Keep};
use super::listen::{Answers, Limits, ListeningServer, listen};
use basrelief_deferred_renderer::{Cut, Page, ServedTexture, TileEncoding};
use basrelief_served::{MOST_TILES, encoding_of, hash_of_picture, hex, join, tag_of};
use basrelief_signals::Texture;
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, PoisonError};

/// What any page may read, with which header.
const HEADERS: &str = "access-control-allow-origin: *\r\naccess-control-expose-headers: etag\r\n";
const BYTES: &str = "application/octet-stream";

/// A picture that is offered.
#[derive(Debug)]
pub(super) struct OfferedPicture {
    texture: Arc<Texture>,
    /// Its layers, kept once they are asked for. Tiles are not: there are as many as ways to cut and to encode them.
    pub(super) pyramid: Mutex<ServedTexture>,
}

/// What is offered.
#[derive(Debug)]
pub struct SceneService {
    scene: Fixed,
    index: Fixed,
    /// The viewer; nothing, where there is none.
    viewer: Site,
    /// By the hash of their texels, in hexadecimal.
    pub(super) pictures: BTreeMap<String, OfferedPicture>,
}

/// What does not change as long as the server runs, with its tag.
type Fixed = (Arc<[u8]>, String);

fn fixed(body: Vec<u8>) -> Fixed {
    let tag = tag_of(&body);
    (body.into(), tag)
}

/// What there is at an address, or why there is nothing, with its status.
type Found = Result<(Vec<u8>, &'static str), (u16, String)>;

impl SceneService {
    /// Offers this scene, as it travels, this page for people, and the pictures of these textures.
    pub fn new(scene: Vec<u8>, index: String, textures: impl IntoIterator<Item = Arc<Texture>>) -> Self {
        let offered = |texture: Arc<Texture>| {
            let pyramid = Mutex::new(ServedTexture::new(Arc::clone(&texture)));
            (hex(&hash_of_picture(&texture)), OfferedPicture { texture, pyramid })
        };
        let pictures = textures.into_iter().map(offered).collect();
        Self { scene: fixed(scene), index: fixed(index.into_bytes()), viewer: Site::default(), pictures }
    }

    /// With these files beside it; what lies at `/` among them is what browsers are shown.
    pub fn with_viewer(self, viewer: Site) -> Self {
        Self { viewer, ..self }
    }

    /// The tile at an address, or several. Encoded without a lock: several at a time.
    pub fn tiles(&self, asked: &str) -> Found {
        let what = "PICTURE/WIDTHxHEIGHT/ENCODING/NUMBER, or several numbers with commas between";
        let wrong = || (400, format!("expected /tile/{what}\n"));
        let (cut, numbers) = asked.rsplit_once('/').ok_or_else(wrong)?;
        let cut = self.cut(cut)?.ok_or_else(wrong)?;
        let numbers: Vec<u32> = numbers.split(',').map(str::parse).collect::<Result<_, _>>().map_err(|_| wrong())?;
        match &numbers[..] {
            [number] => cut.tile(*number).map(|tile| (tile, cut.kind())),
            several if several.len() > MOST_TILES => Err((400, format!("expected at most {MOST_TILES} tiles\n"))),
            several => {
                let mut body = Vec::new();
                for number in several {
                    join(&cut.tile(*number)?, &mut body);
                }
                Ok((body, BYTES))
            }
        }
    }

    /// Bytes of all tiles of a layer.
    fn bytes(&self, asked: &str) -> Found {
        let wrong = || (400, "expected /bytes/PICTURE/WIDTHxHEIGHT/ENCODING/LAYER\n".to_owned());
        let (cut, layer) = asked.rsplit_once('/').ok_or_else(wrong)?;
        let cut = self.cut(cut)?.ok_or_else(wrong)?;
        let (layers, layer) = (cut.page().layers, layer.parse::<usize>().map_err(|_| wrong())?);
        let found = layers.get(layer).ok_or_else(|| (404, format!("this picture has {} layers\n", layers.len())))?;
        let tiles = found.base..found.base + found.pitch * found.rows;
        let bytes = tiles.map(|number| cut.tile(number).map(|tile| tile.len() as u64)).sum::<Result<u64, _>>()?;
        Ok((bytes.to_string().into_bytes(), "text/plain; charset=utf-8"))
    }

    /// A picture, how it is cut, and how its tiles are encoded; none where that is not what is asked for.
    fn cut(&self, asked: &str) -> Result<Option<CutPicture<'_>>, (u16, String)> {
        let parts: Vec<&str> = asked.split('/').collect();
        let [picture, size, encoding] = parts[..] else { return Ok(None) };
        let side = |s: &str| s.parse::<u32>().ok().filter(|n| n.is_power_of_two() && (4..=512).contains(n));
        let size = size.split_once('x').and_then(|(width, height)| Some([side(width)?, side(height)?]));
        let (Some(tile), Some((encoding, quality))) = (size, encoding_of(encoding)) else { return Ok(None) };
        let Some(offered) = self.pictures.get(picture) else {
            return Err((404, "there is no such picture: the server may have another scene by now\n".into()));
        };
        Ok(Some(CutPicture { offered, cut: Cut { tile, ..Cut::default() }, encoding, quality }))
    }

    /// Answers at an address, from now on; port 0 takes any that is free. The address, and what is waited for.
    ///
    /// # Errors
    /// A sentence, where the address cannot be listened at.
    pub fn listen(self, address: SocketAddr, limits: Limits) -> Result<(SocketAddr, ListeningServer), String> {
        listen(self, address, limits).map_err(|e| format!("{address}: cannot be listened at: {e}"))
    }
}

impl Answers for SceneService {
    fn answer(&self, path: &str) -> Answer {
        if let Some(file) = self.viewer.file(path) {
            return file;
        }
        let found = match path {
            "/" | "/served" => return Answer::found(self.index.clone(), "text/html; charset=utf-8", Keep::WhileItLasts),
            "/scene" => return Answer::found(self.scene.clone(), BYTES, Keep::WhileItLasts),
            _ => match (path.strip_prefix("/tile/"), path.strip_prefix("/bytes/")) {
                (Some(asked), _) => self.tiles(asked),
                (_, Some(asked)) => self.bytes(asked),
                _ => Err((404, "expected /, /served, /scene, /tile/... or /bytes/...\n".into())),
            },
        };
        match found {
            Ok((body, kind)) => Answer::found(fixed(body), kind, Keep::ForEver),
            Err((status, why)) => Answer::refused(status, why),
        }
    }

    fn headers(&self) -> &str {
        HEADERS
    }
}

/// A picture as it is asked for.
struct CutPicture<'a> {
    offered: &'a OfferedPicture,
    cut: Cut,
    encoding: TileEncoding,
    quality: u8,
}

impl CutPicture<'_> {
    fn page(&self) -> Page {
        Page::new(0, &self.offered.texture, self.cut, 0)
    }

    fn tile(&self, number: u32) -> Result<Vec<u8>, (u16, String)> {
        let page = self.page();
        if number >= page.tiles() {
            return Err((404, format!("this picture has {} tiles\n", page.tiles())));
        }
        let texels = self.offered.pyramid.lock().unwrap_or_else(PoisonError::into_inner).tile(&page, number);
        let (first, end) = page.texels_of(number);
        let encoded = self.encoding.encode(&texels, [end[0] - first[0], end[1] - first[1]], self.quality);
        encoded.map_err(|e| (500, e))
    }

    /// As browsers name kinds of files.
    fn kind(&self) -> &'static str {
        match self.encoding {
            TileEncoding::Raw => BYTES,
            TileEncoding::Png => "image/png",
            TileEncoding::Jpeg => "image/jpeg",
        }
    }
}
