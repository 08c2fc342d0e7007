//! What travels between the units behind the rasterizer. Tokens are small; what is constant over a polygon travels
//! once, in the control token ahead of its fragments.

use crate::Frame;
use arrayvec::ArrayVec;
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
pub type Stamp<T> = ArrayVec<T, MAX_STAMP>;

/// Values of the fragments of a stamp, side by side. What the lanes behind the last fragment hold means nothing.
pub trait Lanes: Copy {
    /// That of one fragment.
    type Value;
    /// The same for every fragment.
    fn all(value: Self::Value) -> Self;
    /// That of fragment `lane` of the stamp.
    fn lane(&self, lane: usize) -> Self::Value;
}

impl<T: Copy> Lanes for [T; MAX_STAMP] {
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

/// Pseudo-normals of the fragments of a stamp: all x, all y, all z, as they are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Normals(pub [[i16; MAX_STAMP]; 3]);

impl Lanes for Normals {
    type Value = [i16; 3];

    #[inline]
    fn all(value: [i16; 3]) -> Self {
        Self(value.map(|component| [component; MAX_STAMP]))
    }

    #[inline]
    fn lane(&self, lane: usize) -> [i16; 3] {
        self.0.map(|components| components[lane])
    }
}

/// One sample of each fragment of a stamp: at a MIP level, or at a texel of one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sample<V> {
    /// MIP level, 0..=7: selects VQ table (121) and CLUT (122).
    pub level: u8,
    /// Share in the brightness of the fragment; those of a fragment sum to 1.
    pub weight: [f32; MAX_STAMP],
    /// What was sampled.
    pub value: V,
}

impl<V: Lanes> Sample<V> {
    /// The same for every fragment.
    #[inline]
    pub fn all(level: u8, weight: f32, value: V::Value) -> Self {
        Self { level, weight: [weight; MAX_STAMP], value: V::all(value) }
    }

    /// Level, weight and value of fragment `lane` of the stamp.
    #[inline]
    pub fn of(&self, lane: usize) -> (u8, f32, V::Value) {
        (self.level, self.weight[lane], self.value.lane(lane))
    }
}

/// Samples of a stamp, 1..=[`MAX_SAMPLES`]; with two, those of the two adjacent MIP levels, nothing is allocated.
pub type Samples<V> = SmallVec<[Sample<V>; 2]>;

/// Mapping unit (108) to replacement unit (110).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PseudoNormals {
    /// Where.
    pub stamp: Stamp<Fragment>,
    /// Pseudo-normals N': world space, fixed point, scaled so that the largest component is +-32767. The order of inner
    /// products does not depend on its length, so nothing is lost and no square root is needed (assumed).
    pub samples: Samples<Normals>,
}

/// Replacement unit (110) to brightness fetch unit (112): only indexes are kept on the surface.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Indexes {
    /// Where.
    pub stamp: Stamp<Fragment>,
    /// Numbers of the reference normals in the table of their level, from 0; as many samples as there were pseudo-normals.
    pub samples: Samples<[u16; MAX_STAMP]>,
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
