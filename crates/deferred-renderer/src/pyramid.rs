//! Pyramid (134): the texels of a texture, layer by layer.

use crate::Page;
use basrelief_signals::Texture;
use std::sync::Arc;

/// Texels of one layer, row by row.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LayerTexels {
    /// Width and height \[texels\].
    pub size: [u32; 2],
    /// `width * height` texels; the fourth byte is padding.
    pub texels: Vec<[u8; 4]>,
}

impl LayerTexels {
    /// A black layer.
    pub fn new(size: [u32; 2]) -> Self {
        Self { size, texels: vec![[0; 4]; size[0] as usize * size[1] as usize] }
    }

    /// A texel; the coordinates lie inside.
    #[inline]
    pub fn at(&self, x: u32, y: u32) -> [u8; 4] {
        self.texels[(y * self.size[0] + x) as usize]
    }

    /// The texels of a rectangle, row by row.
    pub fn cut(&self, (first, end): ([u32; 2], [u32; 2])) -> impl Iterator<Item = [u8; 4]> + '_ {
        (first[1]..end[1]).flat_map(move |y| (first[0]..end[0]).map(move |x| self.at(x, y)))
    }

    /// Puts texels into a rectangle, row by row.
    pub fn put(&mut self, (first, end): ([u32; 2], [u32; 2]), texels: &[[u8; 4]]) {
        let width = (end[0] - first[0]) as usize;
        for (y, row) in (first[1]..end[1]).zip(texels.chunks_exact(width)) {
            let start = (y * self.size[0] + first[0]) as usize;
            self.texels[start..start + width].copy_from_slice(row);
        }
    }

    /// Fills a rectangle with averages of the next finer layer: (sum of 4 + 2) >> 2 per channel. Where a side of the finer
    /// layer is odd, its last texel is repeated.
    pub fn average(&mut self, finer: &LayerTexels, (first, end): ([u32; 2], [u32; 2])) {
        for y in first[1]..end[1] {
            for x in first[0]..end[0] {
                self.texels[(y * self.size[0] + x) as usize] = finer.averaged(x, y);
            }
        }
    }

    fn averaged(&self, x: u32, y: u32) -> [u8; 4] {
        let right = (2 * x + 1).min(self.size[0] - 1);
        let below = (2 * y + 1).min(self.size[1] - 1);
        let four = [self.at(2 * x, 2 * y), self.at(right, 2 * y), self.at(2 * x, below), self.at(right, below)];
        std::array::from_fn(|c| ((four.iter().map(|t| u32::from(t[c])).sum::<u32>() + 2) >> 2) as u8)
    }
}

/// The texture memory (114) of the server: all layers of one texture, built by the device's own rule when they are asked for.
#[derive(Clone, Debug)]
pub struct ServedTexture {
    texture: Arc<Texture>,
    /// Layers above the finest, finest first.
    coarser: Vec<LayerTexels>,
    finest: LayerTexels,
}

impl ServedTexture {
    /// Offers a texture; one without texels is a single white one.
    pub fn new(texture: Arc<Texture>) -> Self {
        let finest = texture.levels.first().filter(|image| !image.texels.is_empty()).map_or_else(
            || LayerTexels { size: [1, 1], texels: vec![[255; 4]] },
            |image| LayerTexels { size: [image.width, image.height], texels: image.texels.clone() },
        );
        Self { texture, coarser: Vec::new(), finest }
    }

    /// The texture.
    pub fn texture(&self) -> &Arc<Texture> {
        &self.texture
    }

    /// The texels of a tile, row by row.
    pub fn tile(&mut self, page: &Page, tile: u32) -> Vec<[u8; 4]> {
        let depth = page.layer_of(tile);
        let above = usize::from(page.left_out + page.dmax() - depth);
        while self.coarser.len() < above {
            let finer = self.coarser.last().unwrap_or(&self.finest);
            let mut next = LayerTexels::new(finer.size.map(|n| n.div_ceil(2)));
            let all = ([0, 0], next.size);
            next.average(finer, all);
            self.coarser.push(next);
        }
        let layer = if above == 0 { &self.finest } else { &self.coarser[above - 1] };
        layer.cut(page.texels_of(tile)).collect()
    }
}
