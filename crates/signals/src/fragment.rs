//! What travels between the units behind the rasterizer. Tokens are small; what is constant over a polygon travels
//! once, in the control token ahead of its fragments.

use crate::Frame;
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;
use std::sync::Arc;

/// Most pseudo-normals per fragment: eight MIP levels, or two levels of four texels.
pub const MAX_SAMPLES: usize = 8;

/// A pixel covered by a polygon.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Fragment {
    /// Column, from the left.
    pub x: u16,
    /// Row, from the top.
    pub y: u16,
    /// Depth in steps of the z-buffer, 0 = near.
    pub z: u32,
    /// Perspective-correct weights of the second and third vertex of its triangle (the first has the rest).
    pub weights: [f32; 2],
    /// Triangle of the polygon's fan: vertices 0, `triangle + 1`, `triangle + 2`.
    pub triangle: u16,
}

/// Most items of a [`Stamp`].
pub const MAX_STAMP: usize = 4;

/// Neighbours on the screen: items of pixels of one triangle in one 4 x 4 block of the picture, in the order of the scan. A
/// token as wide as that (McCormack et al. 1998 call the pixels that move together a stamp). At most [`MAX_STAMP`], as
/// `rasterizer.stamp` says, and at least one.
///
/// What a token costs the host, it costs once per stamp; what it costs the device, the units charge by its items.
pub type Stamp<T> = SmallVec<[T; MAX_STAMP]>;

/// Samples of the fragments of a stamp: those of the first fragment, then those of the second ... as many for each.
pub type Samples<T> = SmallVec<[T; 2 * MAX_STAMP]>;

/// A pseudo-normal N' of a fragment, at a MIP level or at a texel of one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PseudoNormal {
    /// Share in the brightness of the fragment; those of a fragment sum to 1.
    pub weight: f32,
    /// World space, fixed point, scaled so that its largest component is +-32767: the order of inner products does not
    /// depend on its length, so nothing is lost and no square root is needed (assumed).
    pub normal: [i16; 3],
    /// MIP level, 0..=7: selects VQ table (121) and CLUT (122).
    pub level: u8,
}

/// Mapping unit (108) to replacement unit (110).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PseudoNormals {
    /// Where.
    pub stamp: Stamp<Fragment>,
    /// 1..=[`MAX_SAMPLES`] per fragment.
    pub samples: Samples<PseudoNormal>,
}

/// Index of the reference normal that a pseudo-normal is replaced with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Index {
    /// Share in the brightness of the fragment.
    pub weight: f32,
    /// Number in the level's table, from 0.
    pub index: u16,
    /// Level of table and CLUT.
    pub level: u8,
}

/// Replacement unit (110) to brightness fetch unit (112): only indexes are kept on the surface.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Indexes {
    /// Where.
    pub stamp: Stamp<Fragment>,
    /// As many per fragment as there were pseudo-normals.
    pub samples: Samples<Index>,
}

/// How many of `samples` samples each of `items` items has; at least 1.
#[inline]
pub fn samples_per_item(samples: usize, items: usize) -> usize {
    if samples <= items { 1 } else { samples / items.max(1) }
}

/// Brightness fetch unit (112) to graphics processor (104).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Shaded {
    /// Where.
    pub fragment: Fragment,
    /// Brightness: ambient + diffuse (+ specular where `brightness.components = combined`).
    pub brightness: f32,
    /// Specular brightness, added after blending; 0 where combined.
    pub highlight: f32,
}

/// Graphics processor (104) to frame buffer (126).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Pixel {
    /// Column.
    pub x: u16,
    /// Row.
    pub y: u16,
    /// Depth.
    pub z: u32,
    /// Final colour, 8 bits each.
    pub rgb: [u8; 3],
}

/// Pixels of one 4 x 4 block of the picture, in a token as wide as that.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PixelBlock {
    /// Column and row of the block \[blocks of 4 x 4 pixels\].
    pub at: [u16; 2],
    /// Which pixels are meant: bit 4 * row + column.
    pub mask: u16,
    /// Colours, 8 bits each, by the number of their bit.
    pub rgb: [[u8; 3]; 16],
}

/// What a buffer takes that shows one picture of a frame after the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum PictureFlow {
    /// A frame begins.
    Frame(Arc<Frame>),
    /// Final colours of pixels.
    Pixels(PixelBlock),
    /// The picture is complete, to be shown; whether it is the last of its frame.
    Show {
        /// No better one follows.
        last: bool,
    },
}
