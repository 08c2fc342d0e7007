//! Tokens between the units behind the rasterizer. Tokens are small: values that are constant over a polygon travel once, in the
//! control token ahead of its fragments.

use crate::Frame;
use crate::MapInline as _;
use arrayvec::ArrayVec;
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;
use std::sync::Arc;

/// Maximum number of pseudo-normals per fragment: eight MIP levels, or two levels of four texels.
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
    /// Perspective-correct weights of the second and third vertex of the triangle. The first vertex has the rest.
    pub weights: [f32; 2],
    /// Triangle of the polygon's fan: vertices 0, `triangle + 1`, `triangle + 2`.
    pub triangle: u16,
}

/// Maximum number of items of a [`Stamp`].
pub const MAX_STAMP: usize = 4;

/// Neighbours on the screen: 1 to [`MAX_STAMP`] items, for pixels of one triangle in one 4 x 4 block of the picture, in scan
/// order. The parameter `rasterizer.stamp` sets the largest number. McCormack et al. (1998) call pixels that move together a
/// stamp.
///
/// The host pays for a token once per stamp. The units charge the device's cost per item.
pub type Stamp<T> = ArrayVec<T, MAX_STAMP>;

/// Values of the fragments of a stamp, side by side. Lanes behind the last fragment hold arbitrary values.
pub trait StampLanes: Copy {
    /// Value of one fragment.
    type Value;
    /// Returns lanes with the same value for every fragment.
    fn all(value: Self::Value) -> Self;
    /// Returns the value of fragment `lane` of the stamp.
    fn lane(&self, lane: usize) -> Self::Value;
}

impl<T: Copy> StampLanes for [T; MAX_STAMP] {
    type Value = T;

    #[inline]
    fn all(value: T) -> Self {
        [value; MAX_STAMP]
    }

    #[inline]
    fn lane(&self, lane: usize) -> T {
        self[lane]
    }
}

/// Pseudo-normals of the fragments of a stamp, stored as all x, all y, all z for side-by-side arithmetic.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct StampNormals(pub [[i16; MAX_STAMP]; 3]);

impl StampLanes for StampNormals {
    type Value = [i16; 3];

    #[inline]
    fn all(value: [i16; 3]) -> Self {
        Self(value.map_inline(|component| [component; MAX_STAMP]))
    }

    #[inline]
    fn lane(&self, lane: usize) -> [i16; 3] {
        self.0.map_inline(|components| components[lane])
    }
}

/// One sample of each fragment of a stamp, taken at one MIP level or at one texel of a level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StampSample<V> {
    /// MIP level, 0..=7. It selects the VQ table (121) and the CLUT (122).
    pub level: u8,
    /// Share in the brightness of the fragment. The shares of a fragment sum to 1.
    pub weight: [f32; MAX_STAMP],
    /// Sampled values.
    pub value: V,
}

impl<V: StampLanes> StampSample<V> {
    /// Returns a sample with the same weight and value for every fragment.
    #[inline]
    pub fn all(level: u8, weight: f32, value: V::Value) -> Self {
        Self { level, weight: [weight; MAX_STAMP], value: V::all(value) }
    }

    /// Returns level, weight and value of fragment `lane` of the stamp.
    #[inline]
    pub fn of(&self, lane: usize) -> (u8, f32, V::Value) {
        (self.level, self.weight[lane], self.value.lane(lane))
    }
}

/// Samples of a stamp, 1..=[`MAX_SAMPLES`]. Two samples (the two adjacent MIP levels) need no heap allocation.
pub type StampSamples<V> = SmallVec<[StampSample<V>; 2]>;

/// Token from the mapping unit (108) to the replacement unit (110).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PseudoNormals {
    /// Fragments.
    pub stamp: Stamp<Fragment>,
    /// Pseudo-normals N' in world space, in fixed point, scaled so that the largest component is +-32767. The order of inner
    /// products does not depend on the length of N', so this is exact and needs no square root (assumed).
    pub samples: StampSamples<StampNormals>,
}

/// Token from the replacement unit (110) to the brightness fetch unit (112). Only indexes are kept on the surface.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NormalIndexes {
    /// Fragments.
    pub stamp: Stamp<Fragment>,
    /// Numbers of the reference normals in the table of their level, from 0. There is one sample per sampled pseudo-normal.
    pub samples: StampSamples<[u16; MAX_STAMP]>,
}

/// Token from the brightness fetch unit (112) to the graphics processor (104).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ShadedFragment {
    /// Fragment.
    pub fragment: Fragment,
    /// Brightness: ambient + diffuse (+ specular where `brightness.components = combined`).
    pub brightness: f32,
    /// Specular brightness, added after blending. It is 0 where the components are combined.
    pub highlight: f32,
}

/// Token from the graphics processor (104) to the frame buffer (126).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Pixel {
    /// Column, from the left.
    pub x: u16,
    /// Row, from the top.
    pub y: u16,
    /// Depth.
    pub z: u32,
    /// Final colour, 8 bits each.
    pub rgb: [u8; 3],
}

/// Pixels of one 4 x 4 block of the picture, in one token.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PixelBlock {
    /// Column and row of the block \[blocks of 4 x 4 pixels\].
    pub at: [u16; 2],
    /// Valid pixels: bit 4 * row + column.
    pub mask: u16,
    /// Colours, 8 bits each, indexed by bit number.
    pub rgb: [[u8; 3]; 16],
}

/// Input of a picture buffer that shows several pictures of a frame in sequence.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum PictureFlow {
    /// A frame begins.
    Frame(Arc<Frame>),
    /// Final colours of pixels.
    Pixels(PixelBlock),
    /// The picture is complete and can be shown.
    Show {
        /// True for the last picture of the frame.
        last: bool,
    },
}
