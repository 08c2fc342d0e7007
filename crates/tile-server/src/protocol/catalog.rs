//! Tiles of a server as the renderer knows them: addresses, checks and sizes.

use super::{bytes_path, hex};
use basrelief_deferred_renderer::{PyramidCut, TexturePage, TileEncoding, TileFormat};
use basrelief_signals::Texture;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Maximum size of a tile \[bytes\]; 512 x 512 texels are smaller in every encoding.
pub const MAX_TILE_BYTES: u64 = 1 << 21;

/// Textures on a server, and the format of their tiles.
#[derive(Clone, Debug, Default)]
pub struct TileCatalog {
    /// Format of the tiles.
    pub format: TileFormat,
    /// Hashes of the pictures by texture number.
    pictures: BTreeMap<u32, Arc<str>>,
}

impl TileCatalog {
    /// Makes an empty catalog.
    pub fn new(format: TileFormat) -> Self {
        Self { format, pictures: BTreeMap::new() }
    }

    /// Adds a texture of the scene, which carries the hash of its picture.
    pub fn offer(&mut self, texture: &Texture) {
        if let Some(hash) = &texture.elsewhere {
            self.pictures.insert(texture.id, hex(hash).into());
        }
    }

    /// Returns the hash of the picture of a texture. For an unknown texture the server will report an error.
    pub fn picture(&self, texture: u32) -> Arc<str> {
        self.pictures.get(&texture).cloned().unwrap_or_else(|| "none".into())
    }

    /// Returns the encoded size of all tiles of the finest layer of a texture. Raw tiles have a known size; otherwise `number` requests the
    /// size from the server. Returns `None` if the server does not answer.
    pub fn finest_bytes(
        &self,
        texture: &Texture,
        cut: PyramidCut,
        number: impl FnOnce(&str) -> Result<u64, String>,
    ) -> Option<u64> {
        if self.format.encoding == TileEncoding::Raw {
            return Some(cut.raw_bytes(texture.levels.first().map_or([1; 2], |image| [image.width, image.height])));
        }
        let (picture, layer) = (hex(texture.elsewhere.as_ref()?), TexturePage::new(0, texture, cut, 0).dmax());
        number(&bytes_path(&picture, self.format, layer)).ok()
    }
}
