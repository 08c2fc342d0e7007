//! Tokens between the units of the texture mapping system (300).
//!
//! # Number formats
//! - U, V, W: binary floating point. The scan converter has 53 bits, which represent accumulators with guard bits. Points go to
//!   the dividers with as many significant bits as quotients have (`texel.coordinate_bits`) and an exponent.
//! - u, v in dividers and approximate calculator (310a): fixed point of `texel.coordinate_bits`, with the binary point that the
//!   largest of the triangle's vertices needs ([`ScanSpan::scale`]). Common whole tiles are subtracted first, so that a texture that
//!   repeats a thousand times keeps as many fraction bits as one that does not.
//! - u, v to the look-up table (330): whole tiles are subtracted again, for each packet. The address has 24 bits: at least 12
//!   bits of fraction for a texture of 4,096 texels.
//! - texels to the combiner (350): 8 bits and 8 bits of fraction; illuminance: 2 bits and 14 bits of fraction.

use crate::fixed::nearest;
use basrelief_signals::{DepthToken, PACKET_PIXELS, Packet, PixelToken};
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

/// U, V and W of a point: `u = U / W`, `v = V / W`, all three linear on the screen. W is |1 / w| of clip space.
pub type Uvw = [f64; 3];

/// Returns n of the least 2^n above this |u|, which scales u into fixed point. Returns 0 for 0 and for NaN.
pub fn scale_of(largest: f64) -> i16 {
    if largest > 0.0 && largest.is_finite() { libm::frexp(largest).1 as i16 } else { 0 }
}

/// Token from scan converter to step calculator: the part of a scan line in a triangle, in the direction of marching.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ScanSpan {
    /// Row, from the top.
    pub y: u16,
    /// Column of the first pixel.
    pub x: u16,
    /// Number of pixels, at least 1.
    pub count: u16,
    /// True for marching from right to left.
    pub backwards: bool,
    /// True if the polygon has a texture. Otherwise u and v are undefined.
    pub textured: bool,
    /// Triangle of the polygon's fan.
    pub triangle: u16,
    /// Exponents n: u and v of the triangle are below 2^n, and U and V here are divided by 2^n.
    pub scale: [i16; 2],
    /// Exact values at the first and the last pixel.
    pub ends: [Uvw; 2],
    /// Change per pixel.
    pub step: Uvw,
    /// Depth of the first pixel, and its change per pixel \[steps of the z-buffer\].
    pub depth: [f64; 2],
    /// Weights of the second and third vertex of the triangle, linear on the screen, at the first and the last pixel.
    pub weights: [[f32; 2]; 2],
}

impl ScanSpan {
    /// Returns the number of the last pixel, counted from 0.
    #[inline]
    pub fn last(&self) -> u16 {
        self.count.saturating_sub(1)
    }

    /// Returns the exact U, V, W of pixel `k`.
    #[inline]
    pub fn value(&self, k: u16) -> Uvw {
        if k >= self.last() && k > 0 {
            return self.ends[1];
        }
        std::array::from_fn(|i| self.ends[0][i] + f64::from(k) * self.step[i])
    }

    /// Returns the point at pixel `k`, with `bits` significant bits.
    #[inline]
    pub fn point(&self, k: u16, bits: u32) -> DivisionPoint {
        DivisionPoint(self.value(k).map(|c| nearest(c, bits)))
    }

    /// Returns the column of pixel `k`.
    #[inline]
    pub fn column(&self, k: u16) -> u16 {
        if self.backwards { self.x.saturating_sub(k) } else { self.x.saturating_add(k) }
    }

    /// Returns the pixels from `k` on that lie in the same cell of a [`Packet`].
    #[inline]
    pub fn in_cell(&self, k: u16) -> u16 {
        let position = self.column(k) % PACKET_PIXELS as u16;
        let room = if self.backwards { position + 1 } else { PACKET_PIXELS as u16 - position };
        room.min(self.count - k)
    }
}

/// Token from scan converter to illuminance value generator (340): a span.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LitSpan {
    /// Row, from the top.
    pub y: u16,
    /// Column of the first pixel.
    pub x: u16,
    /// Number of pixels, at least 1.
    pub count: u16,
    /// True for marching from right to left.
    pub backwards: bool,
    /// Triangle of the polygon's fan.
    pub triangle: u16,
    /// Weights of the second and third vertex of the triangle, linear on the screen, at the first and the last pixel.
    pub weights: [[f32; 2]; 2],
}

/// Token from step calculator to approximate calculator (310a): the pixels between two division points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LineSegment {
    /// Span of the segment.
    pub span: ScanSpan,
    /// Division point at the start, counted in pixels of the span.
    pub from: u16,
    /// Division point at the end.
    pub to: u16,
    /// Pixels to generate, from `from` on. The point at the end is the first pixel of the next segment, if one begins there.
    pub walk: u16,
    /// True if every pixel is a division point.
    pub exact: bool,
    /// True if U / W and V / W at `from` come with the segment. Otherwise they are those of the end of the previous segment.
    pub fresh: bool,
}

/// A point to be divided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DivisionPoint(pub Uvw);

/// u and v of a point in fixed point: u / 2^n in steps of 2^-(`texel.coordinate_bits` - 1) (see [`ScanSpan::scale`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FixedCoordinates(pub [i64; 2]);

/// Token from step calculator to divider: points to be divided. One per segment, two if the start is unknown, all if every pixel
/// is a division point, none without a texture.
pub type DivisionPoints = SmallVec<[DivisionPoint; 2]>;

/// Token from divider to approximate calculator (310a): u and v at these points.
pub type Quotients = SmallVec<[FixedCoordinates; 2]>;

/// Token from approximate calculator (310a) to texture look-up table (330): texture coordinates of pixels.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TexelPacket {
    /// Positions of the pixels.
    pub packet: Packet,
    /// Mask of the positions whose coordinates were divided.
    pub points: u16,
    /// u and v by position, minus some whole tiles.
    pub uv: [[f32; 2]; PACKET_PIXELS],
    /// Depths by position.
    pub z: [u32; PACKET_PIXELS],
    /// Displacement of each texel \[pixels\], if requested.
    pub displacement: Option<Box<[f32; PACKET_PIXELS]>>,
}

impl PixelToken for TexelPacket {
    const LINE: [u32; 2] = [PACKET_PIXELS as u32, 1];
    const MOST_PIXELS: u32 = PACKET_PIXELS as u32;

    #[inline]
    fn pixels(&self) -> usize {
        self.packet.pixels()
    }
}

impl DepthToken for TexelPacket {
    /// Levels and illuminance of its pixels are on their way.
    const KEPT_WHEN_EMPTY: bool = true;

    #[inline(always)]
    fn retain(&mut self, mut passes: impl FnMut(u16, u16, u32) -> bool) -> bool {
        let Packet { x, y, .. } = self.packet;
        for i in self.packet.positions() {
            if !passes(x + i as u16, y, self.z[i]) {
                self.packet.mask &= !(1 << i);
            }
        }
        self.packet.mask != 0
    }
}

/// Adding this number to 0 ..= 65535 leaves the nearest whole number in the low 16 bits, because single precision has steps of 1
/// around it. A conversion to an integer would add range checks for each component.
const WHOLE: f32 = 8_388_608.0;

/// Returns the nearest whole number, at most 65535 and at least 0. NaN counts as 0.
#[inline(always)]
#[expect(clippy::manual_clamp, reason = "`clamp` hands a NaN on, `max` drops it")]
pub(crate) fn to_16_bits([r, g, b, a]: [f32; 4]) -> [u16; 4] {
    let whole = |c: f32| (c.max(0.0).min(65_535.0) + WHOLE).to_bits() as u16;
    [whole(r), whole(g), whole(b), whole(a)]
}

/// Token from approximate calculator (310a) to MIP-map selector (320): change of u and v per pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GradientPacket {
    /// Positions of the pixels.
    pub packet: Packet,
    /// du and dv by position.
    pub gradient: [[f32; 2]; PACKET_PIXELS],
}

/// Token from MIP-map selector (320) to texture look-up table (330): map select.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LevelPacket {
    /// Level by position, 0 finest. A fraction is the weight of the next level.
    pub level: [f32; PACKET_PIXELS],
}

/// Token from texture look-up table (330) to combiner (350): texture values.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TexturePacket {
    /// Positions of the pixels.
    pub packet: Packet,
    /// Mask of divided positions, as in [`TexelPacket`].
    pub points: u16,
    /// RGBA by position, in steps of 1/256 of a step of 8 bits.
    pub rgba: [[u16; 4]; PACKET_PIXELS],
    /// Displacements, as in [`TexelPacket`].
    pub displacement: Option<Box<[f32; PACKET_PIXELS]>>,
}

/// Token from illuminance value generator (340) to combiner (350): illuminance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct IlluminancePacket {
    /// Positions of the pixels of the whole span, before hidden pixels are removed.
    pub packet: Packet,
    /// RGBA by position, in steps of 2^-14.
    pub rgba: [[u16; 4]; PACKET_PIXELS],
}

#[cfg(test)]
mod tests {
    use super::to_16_bits;

    #[test]
    fn sixteen_bit_conversion_saturates_and_rounds() {
        assert_eq!(to_16_bits([0.0, 0.4, 0.6, 65_280.0]), [0, 0, 1, 65_280]);
        assert_eq!(to_16_bits([-3.0, f32::NAN, 1e9, 65_534.6]), [0, 0, 65_535, 65_535]);
    }
}
