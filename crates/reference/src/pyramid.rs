//! The pyramid of the rate-limited renderer.

use crate::{PyramidLevels, RenderOptions};
use basrelief_signals::{Image, Texture};
use std::sync::Arc;

/// Cache of textures with the levels that the picture needs. Each is built once.
#[derive(Clone, Debug, Default)]
pub(crate) struct PyramidCache(Vec<(Arc<Texture>, Arc<Texture>)>);

impl PyramidCache {
    /// Returns the texture as it is sampled. The options are the same in every call.
    pub fn of(&mut self, texture: &Arc<Texture>, options: &RenderOptions) -> Arc<Texture> {
        let PyramidLevels::Tiled { tile, .. } = options.pyramid else { return Arc::clone(texture) };
        if let Some((_, made)) = self.0.iter().find(|(given, _)| Arc::ptr_eq(given, texture)) {
            return Arc::clone(made);
        }
        let levels = texture.levels.first().map_or_else(Vec::new, |finest| tiled(finest.clone(), tile));
        let made = Arc::new(Texture { name: texture.name.clone(), levels, ..**texture });
        self.0.push((Arc::clone(texture), Arc::clone(&made)));
        made
    }
}

/// Returns the levels from the finest to the first that fits in one tile.
fn tiled(finest: Image, [columns, rows]: [u32; 2]) -> Vec<Image> {
    let mut levels = Vec::new();
    let mut last = finest;
    while last.width > columns.max(1) || last.height > rows.max(1) {
        let next = halved(&last);
        levels.push(std::mem::replace(&mut last, next));
    }
    levels.push(last);
    levels
}

fn halved(image: &Image) -> Image {
    let (width, height) = (image.width.div_ceil(2), image.height.div_ceil(2));
    let texel = |x: u32, y: u32| {
        let at = y.min(image.height - 1) as usize * image.width as usize + x.min(image.width - 1) as usize;
        image.texels.get(at).copied().unwrap_or([255; 4]).map(u16::from)
    };
    let mean = |x: u32, y: u32| {
        let four = [texel(2 * x, 2 * y), texel(2 * x + 1, 2 * y), texel(2 * x, 2 * y + 1), texel(2 * x + 1, 2 * y + 1)];
        std::array::from_fn(|channel| ((four.iter().map(|t| t[channel]).sum::<u16>() + 2) >> 2) as u8)
    };
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| mean(x, y)).collect();
    Image { width, height, texels }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TexelCentre;

    fn image(width: u32, height: u32) -> Image {
        Image { width, height, texels: (0..width * height).map(|i| [i as u8; 4]).collect() }
    }

    /// Example from the specification of the renderer.
    // Claim: images: 700 x 300 texels have layers of 44 x 19, 88 x 38, 175 x 75, 350 x 150, 700 x 300. An odd edge repeats its last
    // texel. Averages are (sum of 4 + 2) >> 2.
    #[test]
    fn layers_of_700_by_300_texels_end_in_one_tile() {
        let sizes: Vec<_> = tiled(image(700, 300), [64, 64]).iter().map(|l| (l.width, l.height)).collect();
        assert_eq!(sizes, [(700, 300), (350, 150), (175, 75), (88, 38), (44, 19)]);
        assert_eq!(tiled(image(64, 64), [64, 64]).len(), 1);
        assert_eq!(tiled(image(65, 1), [64, 64]).len(), 2);
    }

    // Claim: as layers_of_700_by_300_texels_end_in_one_tile.
    #[test]
    fn odd_edge_repeats_last_texel() {
        let levels = tiled(image(3, 3), [1, 1]);
        // Texels are numbered row by row: 0 1 2 / 3 4 5 / 6 7 8.
        assert_eq!(levels[1].texels.iter().map(|t| t[0]).collect::<Vec<_>>(), [2, 4, 7, 8]);
        assert_eq!(levels[2].texels, [[5; 4]], "(2 + 4 + 7 + 8 + 2) >> 2");
    }

    #[test]
    fn pyramid_is_built_once_and_given_levels_are_kept() {
        let texture = Texture { id: 3, name: "t".into(), levels: vec![image(9, 2)], offset: 7, ..Texture::default() };
        let texture = Arc::new(texture);
        let mut pyramids = PyramidCache::default();
        assert!(Arc::ptr_eq(&pyramids.of(&texture, &RenderOptions::default()), &texture));
        let pyramid = PyramidLevels::Tiled { tile: [4, 4], centre: TexelCentre::Half };
        let options = RenderOptions { pyramid, ..RenderOptions::default() };
        let made = pyramids.of(&texture, &options);
        assert_eq!(made.levels.len(), 3);
        assert!(Arc::ptr_eq(&pyramids.of(&texture, &options), &made));
    }
}
