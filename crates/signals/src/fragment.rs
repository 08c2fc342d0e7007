//! What travels between the units behind the rasterizer. Tokens are small; what is constant over a polygon travels
//! once, in the control token ahead of its fragments.

use serde::{Deserialize, Serialize};

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

/// Mapping unit (108) to replacement unit (110): pseudo-normals N', one per sample (a MIP level, or a texel of one).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PseudoNormals {
    /// Where.
    pub fragment: Fragment,
    /// Samples in use, 1..=[`MAX_SAMPLES`].
    pub count: u8,
    /// MIP level of each sample, 0..=7: selects VQ table (121) and CLUT (122).
    pub level: [u8; MAX_SAMPLES],
    /// Share of each sample in the brightness; they sum to 1.
    pub weight: [f32; MAX_SAMPLES],
    /// N', world space, fixed point, scaled so that its largest component is +-32767: the order of inner products
    /// does not depend on its length, so nothing is lost and no square root is needed (assumed).
    pub normal: [[i16; 3]; MAX_SAMPLES],
}

/// Replacement unit (110) to brightness fetch unit (112): only indexes are kept on the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Indexes {
    /// Where.
    pub fragment: Fragment,
    /// Samples in use.
    pub count: u8,
    /// MIP level of each sample.
    pub level: [u8; MAX_SAMPLES],
    /// Share of each sample.
    pub weight: [f32; MAX_SAMPLES],
    /// Index of the nearest reference normal in the level's table, from 0.
    pub index: [u16; MAX_SAMPLES],
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
