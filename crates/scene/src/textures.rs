//! Textures of one scene: numbering, and places in memory.

use crate::SceneError;
use crate::files::MemoryFiles;
use crate::outside::ImportContext;
use crate::picture::{decode, decode_heights};
use crate::pyramid::{color_levels, height_levels, normal_levels};
use basrelief_input::MemoryReservation;
use basrelief_signals::{Image, Sampler, Texture};
use basrelief_threads::join;
use std::borrow::Cow;
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

/// A picture file, and its use as a texture.
pub(crate) struct TexturePicture<'a> {
    pub(crate) bytes: Cow<'a, [u8]>,
    /// Memory of the bytes.
    pub(crate) _held: MemoryReservation,
    pub(crate) name: String,
    pub(crate) sampler: Sampler,
    pub(crate) content: TextureContent,
}

/// A decoded picture with its levels, without a number and a place in memory.
#[derive(Debug)]
struct DecodedTexture {
    name: String,
    sampler: Sampler,
    content: TextureContent,
    levels: Vec<Image>,
    held: MemoryReservation,
}

impl TexturePicture<'_> {
    /// Decodes the picture and makes its levels.
    fn decode(&self, outside: &ImportContext<'_>) -> Result<DecodedTexture, SceneError> {
        let &Self { ref bytes, ref name, sampler, content, .. } = self;
        let reserve = |held: &mut MemoryReservation, [width, height]: [u32; 2], bytes: u64| {
            let what = format!("levels of {name}, an image of {width} x {height}");
            held.join(outside.take(bytes + TEXTURE + name.len() as u64, "", what).map_err(|e| e.in_file(name))?);
            Ok(())
        };
        let (levels, mut held) = if let TextureContent::Heights(strength) = content {
            let (map, mut held) = decode_heights(bytes, name, outside)?;
            // The second level of heights, and normals of 4 bytes. Both are largest if the picture is a single row.
            let beside = held.bytes() / 2 * 3;
            reserve(&mut held, [map.width, map.height], beside)?;
            (height_levels(map, strength, sampler.wrap), held)
        } else {
            let (image, mut held) = decode(bytes, name, outside)?;
            // The levels take as much again where the picture is a single row, a third of it elsewhere.
            let beside = held.bytes();
            reserve(&mut held, [image.width, image.height], beside)?;
            let is_color = content == TextureContent::Color;
            (if is_color { color_levels(image) } else { normal_levels(image) }, held)
        };
        held.shrink_to(TEXTURE + name.len() as u64 + levels.iter().map(|l| size_of_val(&*l.texels) as u64).sum::<u64>());
        Ok(DecodedTexture { name: name.clone(), sampler, content, levels, held })
    }
}

/// Numbers textures and places them in memory one after the other, colour textures and normal maps apart.
#[derive(Debug, Default)]
pub(crate) struct TextureStore {
    next_id: u32,
    color_end: u64,
    normal_end: u64,
    /// Pictures of one material that are decoded ahead.
    ahead: Vec<DecodedTexture>,
}

impl TextureStore {
    /// Decodes two pictures of a material at the same time, for [`TextureStore::add_ahead`]. They have different contents, and neither has a
    /// texture yet.
    ///
    /// Does nothing if a picture is missing or cannot be decoded, for example because both do not fit in memory together. Decoded one after
    /// the other, they give the same textures and errors.
    pub(crate) fn decode_ahead(&mut self, outside: &ImportContext<'_>, pictures: Option<[TexturePicture<'_>; 2]>) {
        self.ahead.clear();
        let Some([first, second]) = &pictures else { return };
        // Files of the model are not shared with other threads.
        let budget = outside.budget();
        let decoded = |picture: &TexturePicture<'_>| picture.decode(&ImportContext::new(&MemoryFiles::default(), budget)).ok();
        if let (Some(first), Some(second)) = join(|| decoded(first), || decoded(second)) {
            self.ahead.extend([first, second]);
        }
    }

    /// Adds the picture with this content that is [decoded ahead](Self::decode_ahead) as a texture; `None` if there is none.
    pub(crate) fn add_ahead(&mut self, content: TextureContent, outside: &ImportContext<'_>) -> Option<Arc<Texture>> {
        let at = self.ahead.iter().position(|decoded| decoded.content == content)?;
        let decoded = self.ahead.swap_remove(at);
        Some(self.add_decoded(decoded, outside))
    }

    /// Decodes a picture file and adds it as a texture.
    pub(crate) fn decode(
        &mut self,
        picture: &TexturePicture<'_>,
        outside: &ImportContext<'_>,
    ) -> Result<Arc<Texture>, SceneError> {
        let decoded = picture.decode(outside)?;
        Ok(self.add_decoded(decoded, outside))
    }

    fn add_decoded(&mut self, decoded: DecodedTexture, outside: &ImportContext<'_>) -> Arc<Texture> {
        let DecodedTexture { name, sampler, content, levels, held } = decoded;
        outside.keep(held);
        self.add(&name, sampler, content, levels)
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
    use crate::picture::tests::png;
    use crate::pyramid::color_levels;
    use basrelief_input::MemoryPool;

    /// Imports a colour texture and a normal map within a memory limit, ahead of their use or not. Returns their texels.
    fn both(limit: u64, ahead: bool) -> Option<[Vec<Image>; 2]> {
        let (files, budget) = (MemoryFiles::default(), MemoryPool::new(limit));
        let outside = ImportContext::new(&files, &budget);
        let picture = |content, size: u32| {
            let bytes = png(size, size, |x, y| [x as u8, y as u8, 200, 255]).into();
            TexturePicture { bytes, _held: outside.nothing(), name: "a".into(), sampler: Sampler::default(), content }
        };
        let pictures = || [picture(TextureContent::Color, 64), picture(TextureContent::Normals, 32)];
        let mut store = TextureStore::default();
        if ahead {
            store.decode_ahead(&outside, Some(pictures()));
            assert!(limit < u64::MAX || store.ahead.len() == 2);
        }
        let mut texture = |picture: TexturePicture<'_>| {
            store.add_ahead(picture.content, &outside).or_else(|| store.decode(&picture, &outside).ok())
        };
        let [color, normals] = pictures().map(|picture| Some(texture(picture)?.levels.clone()));
        Some([color?, normals?])
    }

    #[test]
    fn pictures_decoded_ahead_give_the_same_textures() {
        assert_eq!(both(u64::MAX, true).unwrap(), both(u64::MAX, false).unwrap());
    }

    #[test]
    fn memory_for_one_picture_at_a_time_is_enough() {
        let least = (1..4096).map(|kib| kib << 10).find(|limit| both(*limit, false).is_some()).unwrap();
        assert_eq!(both(least, true), both(least, false));
    }

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
