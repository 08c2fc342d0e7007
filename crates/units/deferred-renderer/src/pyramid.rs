//! Pyramid (134): the texels of a texture, layer by layer.

use crate::{TexelArea, TexturePage};
use basrelief_signals::Texture;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Texels of one layer, row by row.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LayerTexels {
    /// Width and height \[texels\].
    pub size: [u32; 2],
    /// `width * height` texels; the fourth byte is padding.
    pub texels: Vec<[u8; 4]>,
}

/// Texels of one layer in a borrowed slice.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LayerSlice<'a> {
    size: [u32; 2],
    texels: &'a [[u8; 4]],
}

impl<'a> LayerSlice<'a> {
    fn row(self, y: u32) -> &'a [[u8; 4]] {
        let start = y as usize * self.size[0] as usize;
        &self.texels[start..start + self.size[0] as usize]
    }

    /// Returns the texels of a rectangle, row by row.
    fn cut(self, area: TexelArea) -> Vec<[u8; 4]> {
        let TexelArea { first, end } = area;
        (first[1]..end[1]).flat_map(|y| &self.row(y)[first[0] as usize..end[0] as usize]).copied().collect()
    }
}

impl LayerTexels {
    /// Creates a black layer.
    pub fn new(size: [u32; 2]) -> Self {
        Self { size, texels: vec![[0; 4]; size[0] as usize * size[1] as usize] }
    }

    pub(crate) fn texels(&self) -> LayerSlice<'_> {
        LayerSlice { size: self.size, texels: &self.texels }
    }

    /// Writes texels into a rectangle, row by row.
    pub fn put(&mut self, area: TexelArea, texels: &[[u8; 4]]) {
        let TexelArea { first, end } = area;
        let width = (end[0] - first[0]) as usize;
        for (y, row) in (first[1]..end[1]).zip(texels.chunks_exact(width)) {
            let start = (y * self.size[0] + first[0]) as usize;
            self.texels[start..start + width].copy_from_slice(row);
        }
    }

    /// Fills a rectangle with averages of the next finer layer: (sum of 4 + 2) >> 2 per channel. At an odd side the finer layer's
    /// last texel is repeated.
    pub(crate) fn average(&mut self, finer: LayerSlice<'_>, area: TexelArea) {
        let TexelArea { first, end } = area;
        for y in first[1]..end[1] {
            let start = y as usize * self.size[0] as usize;
            let own = &mut self.texels[start + first[0] as usize..start + end[0] as usize];
            let [above, below] = [2 * y, 2 * y + 1].map(|y| &finer.row(y.min(finer.size[1] - 1))[2 * first[0] as usize..]);
            for ((own, above), below) in own.iter_mut().zip(above.chunks(2)).zip(below.chunks(2)) {
                *own = averaged([above[0], above[above.len() - 1], below[0], below[below.len() - 1]]);
            }
        }
    }
}

/// Returns (sum of 4 + 2) >> 2 per channel.
#[inline]
fn averaged([a, b, c, d]: [[u8; 4]; 4]) -> [u8; 4] {
    std::array::from_fn(|i| ((u16::from(a[i]) + u16::from(b[i]) + u16::from(c[i]) + u16::from(d[i]) + 2) >> 2) as u8)
}

/// Returns true if two textures have the same picture, under any sampler. The device builds its pyramid only from their finest
/// level.
pub(crate) fn is_same_picture(a: &Texture, b: &Texture) -> bool {
    a.elsewhere == b.elsewhere && a.levels.first() == b.levels.first()
}

/// Texture memory (114) of the server: all layers of one texture, built at first use by the device's own rule.
#[derive(Clone, Debug)]
pub struct ServedTexture {
    texture: Arc<Texture>,
    /// Layers above the finest, finest first.
    coarser: Vec<LayerTexels>,
}

impl ServedTexture {
    /// Creates a texture to be served. A texture without texels becomes a single white one.
    pub fn new(texture: Arc<Texture>) -> Self {
        Self { texture, coarser: Vec::new() }
    }

    /// Returns the texture.
    pub fn texture(&self) -> &Arc<Texture> {
        &self.texture
    }

    fn finest(&self) -> LayerSlice<'_> {
        self.texture.levels.first().filter(|image| !image.texels.is_empty()).map_or(
            LayerSlice { size: [1, 1], texels: &[[255; 4]] },
            |image| LayerSlice { size: [image.width, image.height], texels: &image.texels },
        )
    }

    /// Returns the texels of a tile, row by row.
    pub fn tile(&mut self, page: &TexturePage, tile: u32) -> Vec<[u8; 4]> {
        let depth = page.layer_of(tile);
        let above = usize::from(page.left_out + page.dmax() - depth);
        while self.coarser.len() < above {
            let finer = self.coarser.last().map_or(self.finest(), LayerTexels::texels);
            let mut next = LayerTexels::new(finer.size.map(|n| n.div_ceil(2)));
            next.average(finer, TexelArea { first: [0, 0], end: next.size });
            self.coarser.push(next);
        }
        let layer = if above == 0 { self.finest() } else { self.coarser[above - 1].texels() };
        layer.cut(page.texels_of(tile))
    }
}
