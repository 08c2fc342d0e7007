//! What travels between the units of the texture mapping system (300).
//!
//! # Number formats
//! - U, V, W: binary floating point. The scan converter has 53 bits of them, which stand for accumulators with guard bits; points
//!   go to the dividers with as many significant bits as quotients have (`texel.coordinate_bits`) and an exponent.
//! - u, v in dividers and approximate calculator (310a): fixed point of `texel.coordinate_bits`, its binary point where the largest
//!   of the triangle's vertices needs it ([`Span::scale`]). Whole tiles that they have in common are taken off ahead of it, so that
//!   a texture that repeats a thousand times leaves its fraction as many bits as one that does not.
//! - u, v to the look-up table (330): whole tiles off again, for each packet. Its address is that of 24 bits: of a texture of 4,096
//!   texels at least 12 bits of fraction.
//! - texels to the combiner (350): 8 bits and 8 bits of fraction; illuminance: 2 bits and 14 bits of fraction.

use crate::fixed::nearest;
use basrelief_signals::{DepthToken, PACKET_PIXELS, Packet, PixelToken};
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

/// U, V and W of a point: `u = U / W`, `v = V / W`, and all three are linear on the screen. W is |1 / w| of clip space.
pub type Uvw = [f64; 3];

/// n of the least 2^n above this |u|: what scales u into fixed point. 0 for 0, and for what is no number.
pub fn scale_of(largest: f64) -> i16 {
    if largest > 0.0 && largest.is_finite() { libm::frexp(largest).1 as i16 } else { 0 }
}

/// What of a scan line lies in a triangle: scan converter to step calculator. In the direction of marching.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Span {
    /// Row.
    pub y: u16,
    /// Column of the first pixel.
    pub x: u16,
    /// Pixels, at least 1.
    pub count: u16,
    /// Marching from right to left.
    pub backwards: bool,
    /// There is a texture; else u and v are nobody's business.
    pub textured: bool,
    /// Triangle of the polygon's fan.
    pub triangle: u16,
    /// u and v of its triangle are below 2^n of these; U and V here are over that.
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

impl Span {
    /// The last pixel, counted from 0.
    #[inline]
    pub fn last(&self) -> u16 {
        self.count.saturating_sub(1)
    }

    /// Exact U, V, W of pixel `k`.
    #[inline]
    pub fn value(&self, k: u16) -> Uvw {
        if k >= self.last() && k > 0 {
            return self.ends[1];
        }
        std::array::from_fn(|i| self.ends[0][i] + f64::from(k) * self.step[i])
    }

    /// The point at pixel `k`, with so many significant bits.
    #[inline]
    pub fn point(&self, k: u16, bits: u32) -> Point {
        Point(self.value(k).map(|c| nearest(c, bits)))
    }

    /// Column of pixel `k`.
    #[inline]
    pub fn column(&self, k: u16) -> u16 {
        if self.backwards { self.x.saturating_sub(k) } else { self.x.saturating_add(k) }
    }

    /// Pixels from `k` on that lie in the same cell of a [`Packet`].
    #[inline]
    pub fn in_cell(&self, k: u16) -> u16 {
        let position = self.column(k) % PACKET_PIXELS as u16;
        let room = if self.backwards { position + 1 } else { PACKET_PIXELS as u16 - position };
        room.min(self.count - k)
    }
}

/// A span for the illuminance value generator (340).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LitSpan {
    /// Row.
    pub y: u16,
    /// Column of the first pixel.
    pub x: u16,
    /// Pixels, at least 1.
    pub count: u16,
    /// Marching from right to left.
    pub backwards: bool,
    /// Triangle of the polygon's fan.
    pub triangle: u16,
    /// Weights of the second and third vertex of the triangle, linear on the screen, at the first and the last pixel.
    pub weights: [[f32; 2]; 2],
}

/// What lies between two division points: step calculator to approximate calculator (310a).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Segment {
    /// Of this span.
    pub span: Span,
    /// Division point at its start, counted in pixels of the span.
    pub from: u16,
    /// Division point at its end.
    pub to: u16,
    /// Pixels to generate, from `from` on. The point at the end is the next segment's first pixel, if there is a next one that
    /// begins there.
    pub walk: u16,
    /// Every pixel is a division point.
    pub exact: bool,
    /// U / W and V / W at `from` come with it; else they are those of the end of the segment before.
    pub fresh: bool,
}

/// A point to divide at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Point(pub Uvw);

/// u and v of a point in fixed point: in steps of 2^-(`texel.coordinate_bits` - 1), of u over 2^n (see [`Span::scale`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Coordinates(pub [i64; 2]);

/// Points to divide at: step calculator to divider. One per segment, two where nothing is known of its start, all of them
/// where every pixel is one, none without a texture.
pub type Points = SmallVec<[Point; 2]>;

/// u and v at these points: divider to approximate calculator (310a).
pub type Quotients = SmallVec<[Coordinates; 2]>;

/// Texture coordinates of pixels: approximate calculator (310a) to texture look-up table (330).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TexelPacket {
    /// Where.
    pub packet: Packet,
    /// Positions at which the coordinates were divided, one bit each.
    pub points: u16,
    /// u and v by position, some whole tiles less.
    pub uv: [[f32; 2]; PACKET_PIXELS],
    /// Depths by position.
    pub z: [u32; PACKET_PIXELS],
    /// How far each texel is from its place \[pixels\], where somebody asked.
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

/// Adding it to 0 ..= 65535 leaves the nearest whole number in the low 16 bits: around it, single precision has steps of 1. A
/// conversion to an integer would cost the checks for what does not fit, component by component.
const WHOLE: f32 = 8_388_608.0;

/// The nearest whole number, at most 65535 and at least 0, which NaN counts as.
#[inline(always)]
#[expect(clippy::manual_clamp, reason = "`clamp` hands a NaN on, `max` drops it")]
pub(crate) fn to_16_bits([r, g, b, a]: [f32; 4]) -> [u16; 4] {
    let whole = |c: f32| (c.max(0.0).min(65_535.0) + WHOLE).to_bits() as u16;
    [whole(r), whole(g), whole(b), whole(a)]
}

/// Change of u and v per pixel: approximate calculator (310a) to MIP-map selector (320).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GradientPacket {
    /// Where.
    pub packet: Packet,
    /// du and dv by position.
    pub gradient: [[f32; 2]; PACKET_PIXELS],
}

/// Map select: MIP-map selector (320) to texture look-up table (330).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LevelPacket {
    /// Level by position, 0 finest; a fraction weighs the next one.
    pub level: [f32; PACKET_PIXELS],
}

/// Texture values: texture look-up table (330) to combiner (350).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TexturePacket {
    /// Where.
    pub packet: Packet,
    /// As in [`TexelPacket`].
    pub points: u16,
    /// RGBA by position, in steps of 1/256 of a step of 8 bits.
    pub rgba: [[u16; 4]; PACKET_PIXELS],
    /// As in [`TexelPacket`].
    pub displacement: Option<Box<[f32; PACKET_PIXELS]>>,
}

/// Illuminance: illuminance value generator (340) to combiner (350).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct IlluminancePacket {
    /// Where, of the whole span: no pixel is hidden yet.
    pub packet: Packet,
    /// RGBA by position, in steps of 2^-14.
    pub rgba: [[u16; 4]; PACKET_PIXELS],
}

#[cfg(test)]
mod tests {
    use super::to_16_bits;

    #[test]
    fn sixteen_bits_saturate_and_round() {
        assert_eq!(to_16_bits([0.0, 0.4, 0.6, 65_280.0]), [0, 0, 1, 65_280]);
        assert_eq!(to_16_bits([-3.0, f32::NAN, 1e9, 65_534.6]), [0, 0, 65_535, 65_535]);
    }
}
