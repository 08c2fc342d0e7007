//! Texels that a sample touches, and their weights.

use basrelief_signals::MapInline as _;
use basrelief_signals::{Image, MAX_STAMP, Sampler, TexelFilter, WrapMode};
use std::ops::{Mul, Sub};
use wide::{f32x4, i32x4, u32x4};

/// Texels of a sample and their weights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SampleTaps {
    /// Texels in use: 1 (nearest) or 4 (bilinear).
    pub count: u8,
    /// Column and row of each texel, inside the image: upper left, upper right, lower left, lower right. All are equal if one
    /// texel is in use.
    pub texel: [[u32; 2]; 4],
    /// Shares, which sum to 1.
    pub weight: [f32; 4],
}

/// Samples that are computed side by side in one vector register.
pub const LANES: usize = 4;

const _: () = assert!(LANES == MAX_STAMP, "a stamp has a lane for each of its fragments");

/// Texels of [`LANES`] samples, side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleFootprints {
    /// Texels in use per sample: 1 (nearest) or 4 (bilinear).
    pub count: u8,
    /// Left and right columns, inside the image. They are equal if one texel is in use.
    pub columns: [u32x4; 2],
    /// Upper and lower rows, inside the image. They are equal if one texel is in use.
    pub rows: [u32x4; 2],
    /// Shares of the right column and of the lower row, 0 ..= 1.
    pub shares: [f32x4; 2],
}

impl SampleFootprints {
    /// Returns the shares of each texel, in the order of [`SampleTaps`]. They sum to 1.
    #[inline(always)]
    pub fn weights(&self) -> [f32x4; 4] {
        shares(f32x4::ONE, self.shares)
    }

    /// Returns the number of each texel in an image of this width, row by row, in the order of [`SampleTaps`].
    #[inline(always)]
    pub fn numbers(&self, width: u32) -> [u32x4; 4] {
        let ([left, right], [upper, lower]) = (self.columns, self.rows.map_inline(|row| times(row, width)));
        [upper + left, upper + right, lower + left, lower + right]
    }

    /// Returns texels and weights of sample `lane`.
    #[inline(always)]
    pub fn taps(&self, lane: usize) -> SampleTaps {
        let of = |lanes: u32x4| lanes.to_array()[lane];
        let ([left, right], [upper, lower], [fx, fy]) = (self.columns, self.rows, self.shares);
        let (x0, x1, y0, y1) = (of(left), of(right), of(upper), of(lower));
        let weight = shares(1.0, [fx.to_array()[lane], fy.to_array()[lane]]);
        SampleTaps { count: self.count, texel: [[x0, y0], [x1, y0], [x0, y1], [x1, y1]], weight }
    }
}

/// Returns the shares of the four texels, given the shares of the right column and of the lower row.
#[inline(always)]
fn shares<F: Copy + Mul<Output = F> + Sub<Output = F>>(one: F, [fx, fy]: [F; 2]) -> [F; 4] {
    let (gx, gy) = (one - fx, one - fy);
    [gx * gy, fx * gy, gx * fy, fx * fy]
}

/// Returns coordinates `uv` of samples as the sampler wraps them: 0 ..= 1, whatever the size of the image. In `uv`, 0..1 spans an
/// image, NaN counts as 0, and every other value is legal.
#[inline(always)]
pub fn wrapped(sampler: &Sampler, [u, v]: [f32x4; 2]) -> [f32x4; 2] {
    [fraction(u, sampler.wrap[0]), fraction(v, sampler.wrap[1])]
}

/// Returns the texels of `image` for samples at coordinates that are already [`wrapped`]. The caller passes the filter, because
/// it is a choice of the machine.
#[inline(always)]
pub fn footprints(image: &Image, sampler: &Sampler, filter: TexelFilter, [u, v]: [f32x4; 2]) -> SampleFootprints {
    let (columns, fx) = axis(u, image.width, sampler.wrap[0], filter);
    let (rows, fy) = axis(v, image.height, sampler.wrap[1], filter);
    let count = if filter == TexelFilter::Nearest { 1 } else { 4 };
    SampleFootprints { count, columns, rows, shares: [fx, fy] }
}

/// Computes [`footprints`] for one sample at `uv`, not wrapped yet. (As a call it took a fifth of a run of W5.)
#[inline(always)]
pub fn taps(image: &Image, sampler: &Sampler, filter: TexelFilter, uv: [f32; 2]) -> SampleTaps {
    footprints(image, sampler, filter, wrapped(sampler, uv.map_inline(f32x4::splat))).taps(0)
}

/// Returns the columns or rows at coordinates of 0 ..= 1, and the share of the second.
#[inline(always)]
fn axis(u: f32x4, size: u32, wrap: WrapMode, filter: TexelFilter) -> ([u32x4; 2], f32x4) {
    let size = size.max(1) as f32;
    let x = u * size;
    match filter {
        TexelFilter::Nearest => ([whole(floor_of_place(x).fast_min(f32x4::splat(size - 1.0))); 2], f32x4::ZERO),
        TexelFilter::Bilinear => {
            // One of the two texels may lie outside at either end. It wraps to the other side, or moves in by one.
            let x = x - 0.5;
            let first = floor_of_place(x);
            let second = first + 1.0;
            let back = if wrap == WrapMode::Repeat { size } else { 1.0 };
            let inside = [
                first.simd_lt(f32x4::ZERO).select(first + back, first),
                second.simd_ge(f32x4::splat(size)).select(second - back, second),
            ];
            (inside.map_inline(whole), x - first)
        }
    }
}

/// Wraps coordinates into an image, 0 ..= 1.
///
/// The fraction is taken before the multiplication by a size. This works for every size at the cost of one rounding to an
/// integer, whereas masking the integer part would need a power of two.
#[inline(always)]
fn fraction(u: f32x4, wrap: WrapMode) -> f32x4 {
    let (zero, one) = (f32x4::ZERO, f32x4::ONE);
    let fraction = match wrap {
        WrapMode::Repeat => u - floor(u),
        WrapMode::Mirror => {
            let t = u - floor(u * 0.5) * 2.0;
            t.simd_gt(one).select(2.0 - t, t)
        }
        WrapMode::Clamp => u,
    };
    // Infinity minus infinity and NaN become 0 here: both compare as not above it.
    let positive = fraction.simd_gt(zero).select(fraction, zero);
    positive.fast_min(one)
}

/// Adding this number rounds |x| <= 2^22 to a whole number in the low 22 bits, because single precision has steps of 1 around it.
const WHOLE: f32 = 12_582_912.0;

/// Rounds towards minus infinity, for |x| <= 2^22, the range of positions in images. The rounding uses a sum: without SSE 4.1 the
/// library function is a detour over integers.
#[inline(always)]
fn floor_of_place(x: f32x4) -> f32x4 {
    let nearest = (x + WHOLE) - WHOLE;
    nearest - nearest.simd_gt(x).select(f32x4::ONE, f32x4::ZERO)
}

/// Rounds towards minus infinity.
#[inline(always)]
fn floor(x: f32x4) -> f32x4 {
    x.abs().simd_lt(f32x4::splat(4_194_304.0)).select(floor_of_place(x), x)
}

/// Converts whole numbers 0 ..= 2^22 to integers.
#[inline(always)]
fn whole(x: f32x4) -> u32x4 {
    (x + WHOLE).to_bits() - u32x4::splat(WHOLE.to_bits())
}

/// Multiplies by a width or the side of a block, in most cases a power of two. (Without SSE 4.1 a product is some twenty
/// instructions.)
#[inline(always)]
pub(crate) fn times(lanes: u32x4, n: u32) -> u32x4 {
    if n.is_power_of_two() { lanes.unbounded_shl_scalar(n.trailing_zeros()) } else { lanes * n }
}

/// Returns texels of samples side by side as stored: red, green and blue, 0..=255 each. `missing` stands for a texel that the image
/// lacks because its array is short.
#[inline(always)]
pub fn stored(image: &Image, numbers: u32x4, missing: [u8; 4]) -> [f32x4; 3] {
    let texel = |at: u32| i32::from_le_bytes(image.texels.get(at as usize).copied().unwrap_or(missing));
    let texels = i32x4::new(numbers.to_array().map_inline(texel));
    let component = |texels: i32x4| f32x4::from_i32x4(texels & i32x4::splat(255));
    [component(texels), component(texels.unbounded_shr_scalar(8)), component(texels.unbounded_shr_scalar(16))]
}

/// Decodes a component of normals from its stored form, 0..=255: `v / 127.5 - 1`. The function is linear, so it also accepts
/// filtered values.
#[inline(always)]
pub fn decode_normal(stored: f32x4) -> f32x4 {
    stored * (1.0 / 127.5) - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn image(width: u32, height: u32) -> Image {
        Image { width, height, texels: vec![[0; 4]; (width * height) as usize] }
    }

    fn wrap(wrap: WrapMode) -> Sampler {
        Sampler { wrap: [wrap; 2], filter: TexelFilter::Bilinear }
    }

    fn row(width: u32, mode: WrapMode, u: f32) -> (u32, u32, f32) {
        let t = taps(&image(width, 1), &wrap(mode), TexelFilter::Bilinear, [u, 0.5]);
        (t.texel[0][0], t.texel[1][0], t.weight[1] + t.weight[3])
    }

    #[test]
    fn texel_centres_are_hit_exactly_and_edges_wrap() {
        assert_eq!(row(4, WrapMode::Repeat, 0.375), (1, 2, 0.0));
        assert_eq!(row(4, WrapMode::Repeat, 0.0), (3, 0, 0.5));
        assert_eq!(row(4, WrapMode::Repeat, 1.0), (3, 0, 0.5));
        assert_eq!(row(4, WrapMode::Repeat, 0.9375), (3, 0, 0.25));
        assert_eq!(row(4, WrapMode::Mirror, 0.0), (0, 0, 0.5));
        assert_eq!(row(4, WrapMode::Mirror, 1.625), (1, 2, 0.0));
        assert_eq!(row(4, WrapMode::Mirror, -0.375), (1, 2, 0.0));
        assert_eq!(row(4, WrapMode::Clamp, -3.0), (0, 0, 0.5));
        assert_eq!(row(4, WrapMode::Clamp, 9.0), (3, 3, 0.5));
        assert_eq!(row(4, WrapMode::Repeat, -0.25), (2, 3, 0.5));
    }

    #[test]
    fn nearest_takes_texel_that_holds_point() {
        let at = |mode, u| taps(&image(4, 4), &wrap(mode), TexelFilter::Nearest, [u, 0.0]).texel[0][0];
        assert_eq!(at(WrapMode::Repeat, 0.49), 1);
        assert_eq!(at(WrapMode::Repeat, 0.5), 2);
        assert_eq!(at(WrapMode::Repeat, -0.01), 3);
        assert_eq!(at(WrapMode::Mirror, 1.01), 3);
        assert_eq!(at(WrapMode::Clamp, 7.0), 3);
        assert_eq!(at(WrapMode::Clamp, f32::NAN), 0);
    }

    #[test]
    fn normals_decode_to_their_range() {
        assert_eq!(decode_normal(f32x4::new([0.0, 127.5, 255.0, 0.0])).to_array(), [-1.0, 0.0, 1.0, -1.0]);
    }

    fn any_wrap() -> impl Strategy<Value = WrapMode> {
        prop_oneof![Just(WrapMode::Repeat), Just(WrapMode::Mirror), Just(WrapMode::Clamp)]
    }

    proptest! {
        #[test]
        fn every_coordinate_is_inside_with_weights_of_sum_one(
            u in any::<f32>(), v in prop_oneof![any::<f32>(), -3f32..3.0], w in 1u32..70, h in 1u32..70,
            mode in any_wrap(), nearest in any::<bool>(),
        ) {
            let filter = if nearest { TexelFilter::Nearest } else { TexelFilter::Bilinear };
            let image = Image { width: w, height: h, texels: Vec::new() };
            let t = taps(&image, &wrap(mode), filter, [u, v]);
            prop_assert!((t.weight.iter().sum::<f32>() - 1.0).abs() < 1e-5);
            prop_assert!(t.weight.iter().all(|&s| (0.0..=1.0).contains(&s)));
            prop_assert!(t.texel.iter().all(|&[x, y]| x < w && y < h));
            let uv = wrapped(&wrap(mode), [[0.5, u, v, 0.0], [u, v, u, 1.0]].map(f32x4::new));
            let beside = footprints(&image, &wrap(mode), filter, uv);
            prop_assert_eq!(beside.taps(1), t);
        }

        #[test]
        fn taps_match_double_precision_filter(u in -4f64..4.0, w in 1u32..70, mode in any_wrap()) {
            let x = f64::from(u as f32) * f64::from(w) - 0.5;
            let fold = |i: i64| {
                let (n, i) = (i64::from(w), i);
                match mode {
                    WrapMode::Repeat => i.rem_euclid(n),
                    WrapMode::Clamp => i.clamp(0, n - 1),
                    WrapMode::Mirror => { let m = i.rem_euclid(2 * n); m.min(2 * n - 1 - m) }
                }
            };
            // The value at a texel is its number. The filtered values must agree although the order may be mirrored.
            let value = |i: i64| fold(i) as f64;
            let i = x.floor() as i64;
            let expected = value(i) + (x - x.floor()) * (value(i + 1) - value(i));
            let (a, b, f) = row(w, mode, u as f32);
            let got = f64::from(a) + f64::from(f) * (f64::from(b) - f64::from(a));
            // A jump of the repeating texture is as steep as the image is wide.
            prop_assert!((got - expected).abs() < 1e-4 * f64::from(w), "{got} {expected}");
        }
    }
}
