//! What a renderer knows of the tiles of a server: their addresses, what they must be, and what all of them take.

use super::{encoding_name, hex};
use basrelief_deferred_renderer::{PyramidCut, TexturePage, TileEncoding};
use basrelief_signals::Texture;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Largest tile that is believed: more than 512 x 512 texels take in any encoding \[bytes\].
pub const MAX_TILE_BYTES: u64 = 1 << 21;

/// The textures that a renderer was offered, and how it wants their tiles.
#[derive(Clone, Debug, Default)]
pub struct TileCatalog {
    /// Encoding of tiles, with its quality.
    pub encoding: (TileEncoding, u8),
    /// Hashes of the pictures of the textures, by number.
    pictures: BTreeMap<u32, Arc<str>>,
}

impl TileCatalog {
    /// Nothing yet.
    pub fn new(encoding: (TileEncoding, u8)) -> Self {
        Self { encoding, pictures: BTreeMap::new() }
    }

    /// A texture of the scene: what its picture is called at the server came with it.
    pub fn offer(&mut self, texture: &Texture) {
        if let Some(hash) = &texture.elsewhere {
            self.pictures.insert(texture.id, hex(hash).into());
        }
    }

    /// The hash of a texture's picture. One that was never offered is found out by the server.
    pub fn picture(&self, texture: u32) -> Arc<str> {
        self.pictures.get(&texture).cloned().unwrap_or_else(|| "none".into())
    }

    /// Bytes of all tiles of the finest layer of a texture, as they are encoded: as raw texels the sizes tell it, otherwise the
    /// server, who is asked for the number at an address. None where it does not tell.
    pub fn finest_bytes(
        &self,
        texture: &Texture,
        cut: PyramidCut,
        number: impl FnOnce(&str) -> Result<u64, String>,
    ) -> Option<u64> {
        if self.encoding.0 == TileEncoding::Raw {
            return Some(cut.raw_bytes(texture.levels.first().map_or([1; 2], |image| [image.width, image.height])));
        }
        let (picture, layer) = (hex(texture.elsewhere.as_ref()?), TexturePage::new(0, texture, cut, 0).dmax());
        number(&format!("bytes/{}/{layer}", cut_name(&picture, cut, self.encoding))).ok()
    }
}

/// A picture, how it is cut and how its tiles are encoded, as an address says it.
fn cut_name(picture: &str, cut: PyramidCut, encoding: (TileEncoding, u8)) -> String {
    let [width, height] = cut.tile;
    format!("{picture}/{width}x{height}/{}", encoding_name(encoding))
}

/// Address of tiles of a picture.
pub fn tiles_path(picture: &str, cut: PyramidCut, encoding: (TileEncoding, u8), tiles: &[u32]) -> String {
    let numbers: Vec<String> = tiles.iter().map(u32::to_string).collect();
    format!("tile/{}/{}", cut_name(picture, cut, encoding), numbers.join(","))
}

/// Whether what has come for a tile can be decoded, and has its size.
///
/// # Errors
/// A sentence, where it cannot or has not.
pub fn check_tile(encoding: TileEncoding, page: &TexturePage, tile: u32, body: &[u8]) -> Result<(), String> {
    let (first, end) = page.texels_of(tile);
    encoding.decode(body, [end[0] - first[0], end[1] - first[1]]).map(drop).map_err(|e| format!("corrupt: {e}"))
}
