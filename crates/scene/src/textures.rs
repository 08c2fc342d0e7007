//! Textures of one scene: numbering, and places in memory.

use crate::SceneError;
use crate::outside::ImportContext;
use crate::picture::decode;
use crate::pyramid::{color_levels, height_levels, heights_of, normal_levels};
use basrelief_signals::{Image, Sampler, Texture};
use std::sync::Arc;

/// Memory of a texture beside its name and its texels \[bytes\].
const TEXTURE: u64 = 1 << 10;

/// Content of a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TextureContent {
    /// Colours.
    Color,
    /// Tangent-space normals.
    Normals,
    /// Heights, this many texels high; becomes a normal map.
    Heights(f64),
}

/// Numbers textures and places them in memory one after the other, colour textures and normal maps apart.
#[derive(Debug, Default)]
pub(crate) struct TextureStore {
    next_id: u32,
    color_end: u64,
    normal_end: u64,
}

impl TextureStore {
    /// Decodes a picture file and adds it as a texture.
    pub(crate) fn decode(
        &mut self,
        bytes: &[u8],
        name: &str,
        sampler: Sampler,
        content: TextureContent,
        outside: &ImportContext<'_>,
    ) -> Result<Arc<Texture>, SceneError> {
        let (image, mut held) = decode(bytes, name, outside)?;
        // The levels take as much again where the picture is a single row, a third of it elsewhere; heights have 8 bytes each.
        let finest = held.bytes();
        let beside = if let TextureContent::Heights(_) = content { 4 * finest } else { finest };
        let what = format!("levels of {name}, a picture of {} x {}", image.width, image.height);
        held.join(outside.take(beside + TEXTURE + name.len() as u64, "", what).map_err(|e| e.in_file(name))?);
        let levels = match content {
            TextureContent::Color => color_levels(image),
            TextureContent::Normals => normal_levels(image),
            TextureContent::Heights(strength) => {
                let heights = heights_of(&image);
                drop(image);
                height_levels(heights, strength, sampler.wrap)
            }
        };
        held.shrink_to(TEXTURE + name.len() as u64 + levels.iter().map(|l| size_of_val(&*l.texels) as u64).sum::<u64>());
        outside.keep(held);
        Ok(self.add(name, sampler, content, levels))
    }

    /// Adds a finished pyramid as a texture.
    pub(crate) fn add(&mut self, name: &str, sampler: Sampler, content: TextureContent, levels: Vec<Image>) -> Arc<Texture> {
        let end = if content == TextureContent::Color { &mut self.color_end } else { &mut self.normal_end };
        let offset = *end;
        *end += levels.iter().map(padded_texels).sum::<u64>();
        let id = self.next_id;
        self.next_id += 1;
        Arc::new(Texture { id, name: name.into(), sampler, levels, offset, elsewhere: None })
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
        let a = store.add("a", Sampler::default(), TextureContent::Color, levels());
        let b = store.add("b", Sampler::default(), TextureContent::Normals, levels());
        let c = store.add("c", Sampler::default(), TextureContent::Color, levels());
        let d = store.add("d", Sampler::default(), TextureContent::Heights(1.0), levels());
        assert_eq!([a.id, b.id, c.id, d.id], [0, 1, 2, 3]);
        // 6 x 4 -> 2 x 1 blocks, 3 x 2 -> 1, 1 x 1 -> 1: four blocks of 16 texels.
        assert_eq!([a.offset, b.offset, c.offset, d.offset], [0, 0, 64, 64]);
    }
}
