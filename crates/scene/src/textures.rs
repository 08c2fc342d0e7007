//! Textures of one scene: numbering, places in memory, and the limit on what untrusted files may decode to.

use crate::SceneError;
use crate::picture::decode;
use crate::pyramid::{color_levels, height_levels, heights_of, normal_levels};
use basrelief_signals::{Image, Sampler, Texture};
use std::sync::Arc;

/// Most texels of all finest levels together: 512 MiB, 683 MiB with their pyramids.
const MAX_TEXELS: u64 = 1 << 27;

/// What a texture holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Content {
    /// Colours.
    Color,
    /// Tangent-space normals.
    Normals,
    /// Heights, this many texels high; becomes a normal map.
    Heights(f64),
}

/// Numbers textures and places them in memory one after the other, colour textures and normal maps apart.
#[derive(Debug)]
pub(crate) struct TextureStore {
    next_id: u32,
    color_end: u64,
    normal_end: u64,
    texels_left: u64,
}

impl Default for TextureStore {
    fn default() -> Self {
        Self { next_id: 0, color_end: 0, normal_end: 0, texels_left: MAX_TEXELS }
    }
}

impl TextureStore {
    /// Decodes a picture file and adds it as a texture.
    pub(crate) fn decode(
        &mut self,
        bytes: &[u8],
        name: &str,
        sampler: Sampler,
        content: Content,
    ) -> Result<Arc<Texture>, SceneError> {
        let image = decode(bytes, name, self.texels_left)?;
        self.texels_left -= image.texels.len() as u64;
        let levels = match content {
            Content::Color => color_levels(image),
            Content::Normals => normal_levels(image),
            Content::Heights(strength) => height_levels(heights_of(&image), strength, sampler.wrap),
        };
        Ok(self.add(name, sampler, content, levels))
    }

    /// Adds a finished pyramid as a texture.
    pub(crate) fn add(&mut self, name: &str, sampler: Sampler, content: Content, levels: Vec<Image>) -> Arc<Texture> {
        let end = if content == Content::Color { &mut self.color_end } else { &mut self.normal_end };
        let offset = *end;
        *end += levels.iter().map(padded_texels).sum::<u64>();
        let id = self.next_id;
        self.next_id += 1;
        Arc::new(Texture { id, name: name.into(), sampler, levels, offset })
    }
}

/// Texels that a level takes in memory: whole 4 x 4 blocks.
fn padded_texels(level: &Image) -> u64 {
    u64::from(level.width.div_ceil(4)) * u64::from(level.height.div_ceil(4)) * 16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pyramid::color_levels;

    #[test]
    fn textures_follow_each_other_in_their_own_memory() {
        let mut store = TextureStore::default();
        let levels = || color_levels(Image { width: 6, height: 4, texels: vec![[0; 4]; 24] });
        let a = store.add("a", Sampler::default(), Content::Color, levels());
        let b = store.add("b", Sampler::default(), Content::Normals, levels());
        let c = store.add("c", Sampler::default(), Content::Color, levels());
        let d = store.add("d", Sampler::default(), Content::Heights(1.0), levels());
        assert_eq!([a.id, b.id, c.id, d.id], [0, 1, 2, 3]);
        // 6 x 4 -> 2 x 1 blocks, 3 x 2 -> 1, 1 x 1 -> 1: four blocks of 16 texels.
        assert_eq!([a.offset, b.offset, c.offset, d.offset], [0, 0, 64, 64]);
    }
}
