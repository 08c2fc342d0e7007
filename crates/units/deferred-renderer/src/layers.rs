//! Layers of a pyramid (134), and their division into tiles.

use serde::{Deserialize, Serialize};

/// Position of texel centres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TexelCentre {
    /// At whole coordinates (the patent): a layer is sampled at S / 2^SF.
    Integer,
    /// At halves: a layer is sampled at S / 2^SF - 0.5, so that layers lie on top of each other.
    #[default]
    Half,
}

/// Division of a texture into layers and tiles, the same for all pages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PyramidCut {
    /// Width and height of a tile \[texels\], powers of two.
    pub tile: [u32; 2],
    /// Position of texel centres.
    pub centre: TexelCentre,
    /// Cap of Dmax (133) \[0033\]: deeper layers are left out.
    pub most_depth: u8,
}

impl Default for PyramidCut {
    fn default() -> Self {
        Self { tile: [64, 64], centre: TexelCentre::Half, most_depth: u8::MAX }
    }
}

impl PyramidCut {
    /// Returns the layers of a texture of `size` texels from the coarsest to the finest, and the number of finer ones that the
    /// cap leaves out.
    ///
    /// Layers are counted from the top, so the cap changes neither depths nor tile numbers of the remaining layers.
    pub(crate) fn layers(&self, size: [u32; 2]) -> (Vec<PyramidLayer>, u8) {
        let dmax = deepest(size, self.tile);
        let kept = dmax.min(u32::from(self.most_depth));
        let mut base = 0;
        let layer = |depth: u32| {
            let size = halved(size, dmax - depth);
            let [pitch, rows] = [0, 1].map(|i| size[i].div_ceil(self.tile[i]));
            let layer = PyramidLayer { size, pitch, rows, base, scale: 1.0 / (1_u64 << (kept - depth)) as f32 };
            base += pitch * rows;
            layer
        };
        ((0..=kept).map(layer).collect(), (dmax - kept) as u8)
    }

    /// Returns width and height of the finest layer of a texture of `size` texels \[texels\].
    pub fn finest(&self, size: [u32; 2]) -> [u32; 2] {
        halved(size, deepest(size, self.tile).saturating_sub(u32::from(self.most_depth)))
    }

    /// Returns the bytes of the finest layer of a texture of `size` texels, as raw tiles.
    pub fn raw_bytes(&self, size: [u32; 2]) -> u64 {
        self.finest(size).iter().fold(3, |all, side| all * u64::from(*side))
    }
}

/// Returns a size halved `times` times and rounded up.
fn halved(size: [u32; 2], times: u32) -> [u32; 2] {
    size.map(|n| u64::from(n).div_ceil(1 << times) as u32)
}

/// Returns Dmax of the whole texture: the least depth whose coarsest layer fits into one tile.
fn deepest(size: [u32; 2], tile: [u32; 2]) -> u32 {
    let fits = |d: &u32| halved(size, *d).iter().zip(tile).all(|(side, tile)| *side <= tile);
    (0..32).find(fits).unwrap_or(31)
}

/// A layer of a pyramid (134).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PyramidLayer {
    /// Width and height \[texels\].
    pub size: [u32; 2],
    /// Tile pitch (138): tiles per row.
    pub pitch: u32,
    /// Rows of tiles.
    pub rows: u32,
    /// Tile base (140): number of the top-left tile.
    pub base: u32,
    /// Scale 2^-SF: texels of this layer per texel of the finest.
    pub scale: f32,
}
