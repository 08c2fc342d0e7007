//! Which texels a sample touches, and what they weigh.

use basrelief_signals::{Filter, Image, MAX_STAMP, Sampler, Wrap};
use std::ops::{Mul, Sub};
use wide::{f32x4, u32x4};

/// Texels of a sample and their weights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Taps {
    /// Texels in use: 1 (nearest) or 4 (bilinear).
    pub count: u8,
    /// Column and row of each, inside the image: upper left, upper right, lower left, lower right; all the same where
    /// one is in use.
    pub texel: [[u32; 2]; 4],
    /// Shares; they sum to 1.
    pub weight: [f32; 4],
}

/// Samples that are computed side by side, in one vector register.
pub const LANES: usize = 4;

const _: () = assert!(LANES == MAX_STAMP, "a stamp has a lane for each of its fragments");

/// What [`LANES`] samples touch, side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprints {
    /// Texels in use per sample: 1 (nearest) or 4 (bilinear).
    pub count: u8,
    /// Left and right columns, inside the image; the same where one texel is in use.
    pub columns: [u32x4; 2],
    /// Upper and lower rows, inside the image; the same where one texel is in use.
    pub rows: [u32x4; 2],
    /// Shares of the right column and of the lower row, 0 ..= 1.
    pub shares: [f32x4; 2],
}

impl Footprints {
    /// Shares of each texel, in the order of [`Taps`]; they sum to 1.
    #[inline(always)]
    pub fn weights(&self) -> [f32x4; 4] {
        shares(f32x4::ONE, self.shares)
    }

    /// Number of each texel in an image of this width, row by row, in the order of [`Taps`].
    #[inline(always)]
    pub fn numbers(&self, width: u32) -> [u32x4; 4] {
        let ([left, right], [upper, lower]) = (self.columns, self.rows.map(|row| times(row, width)));
        [upper + left, upper + right, lower + left, lower + right]
    }

    /// Texels and weights of sample `lane`.
    #[inline(always)]
    pub fn taps(&self, lane: usize) -> Taps {
        let of = |lanes: u32x4| lanes.to_array()[lane];
        let ([left, right], [upper, lower], [fx, fy]) = (self.columns, self.rows, self.shares);
        let (x0, x1, y0, y1) = (of(left), of(right), of(upper), of(lower));
        let weight = shares(1.0, [fx.to_array()[lane], fy.to_array()[lane]]);
        Taps { count: self.count, texel: [[x0, y0], [x1, y0], [x0, y1], [x1, y1]], weight }
    }
}

/// Shares of the four texels, from those of the right column and of the lower row.
#[inline(always)]
fn shares<F: Copy + Mul<Output = F> + Sub<Output = F>>(one: F, [fx, fy]: [F; 2]) -> [F; 4] {
    let (gx, gy) = (one - fx, one - fy);
    [gx * gy, fx * gy, gx * fy, fx * fy]
}

/// Coordinates `uv` of samples (0..1 spans an image; NaN counts as 0, every other value is legal) as the sampler wraps them: 0 ..= 1,
/// whatever the size of the image.
#[inline(always)]
pub fn wrapped(sampler: &Sampler, [u, v]: [f32x4; 2]) -> [f32x4; 2] {
    [fraction(u, sampler.wrap[0]), fraction(v, sampler.wrap[1])]
}

/// Texels of `image` for samples at coordinates that the sampler has [`wrapped`]. The filter comes from the caller: it is a choice
/// of the machine.
#[inline(always)]
pub fn footprints(image: &Image, sampler: &Sampler, filter: Filter, [u, v]: [f32x4; 2]) -> Footprints {
    let (columns, fx) = axis(u, image.width, sampler.wrap[0], filter);
    let (rows, fy) = axis(v, image.height, sampler.wrap[1], filter);
    let count = if filter == Filter::Nearest { 1 } else { 4 };
    Footprints { count, columns, rows, shares: [fx, fy] }
}

/// [`footprints`] of one sample at `uv`, not wrapped yet. (As a call it took a fifth of a run of W5.)
#[inline(always)]
pub fn taps(image: &Image, sampler: &Sampler, filter: Filter, uv: [f32; 2]) -> Taps {
    footprints(image, sampler, filter, wrapped(sampler, uv.map(f32x4::splat))).taps(0)
}

/// Columns or rows at coordinates of 0 ..= 1, and the share of the second.
#[inline(always)]
fn axis(u: f32x4, size: u32, wrap: Wrap, filter: Filter) -> ([u32x4; 2], f32x4) {
    let size = size.max(1) as f32;
    let x = u * size;
    match filter {
        Filter::Nearest => ([whole(floor_of_place(x).fast_min(f32x4::splat(size - 1.0))); 2], f32x4::ZERO),
        Filter::Bilinear => {
            // One of the two texels around may stick out at either end. It comes back from the other side, or moves in by one.
            let x = x - 0.5;
            let first = floor_of_place(x);
            let second = first + 1.0;
            let back = if wrap == Wrap::Repeat { size } else { 1.0 };
            let inside = [
                first.simd_lt(f32x4::ZERO).select(first + back, first),
                second.simd_ge(f32x4::splat(size)).select(second - back, second),
            ];
            (inside.map(whole), x - first)
        }
    }
}

/// Coordinates wrapped into an image, 0 ..= 1.
///
/// The fraction is taken before the multiplication by a size: it works for every size at the cost of one rounding to an integer,
/// where masking the integer part would need a power of two.
#[inline(always)]
fn fraction(u: f32x4, wrap: Wrap) -> f32x4 {
    let (zero, one) = (f32x4::ZERO, f32x4::ONE);
    let fraction = match wrap {
        Wrap::Repeat => u - floor(u),
        Wrap::Mirror => {
            let t = u - floor(u * 0.5) * 2.0;
            t.simd_gt(one).select(2.0 - t, t)
        }
        Wrap::Clamp => u,
    };
    // Infinity minus infinity and NaN end here as 0: both compare as not above it.
    let positive = fraction.simd_gt(zero).select(fraction, zero);
    positive.fast_min(one)
}

/// Adding it rounds |x| <= 2^22 to a whole number, which then stands in the low 22 bits: around it, single precision has
/// steps of 1.
const WHOLE: f32 = 12_582_912.0;

/// Round towards minus infinity, for |x| <= 2^22: places in images are. By way of a sum: without SSE 4.1 the library function is a
/// detour over integers.
#[inline(always)]
fn floor_of_place(x: f32x4) -> f32x4 {
    let nearest = (x + WHOLE) - WHOLE;
    nearest - nearest.simd_gt(x).select(f32x4::ONE, f32x4::ZERO)
}

/// Round towards minus infinity.
#[inline(always)]
fn floor(x: f32x4) -> f32x4 {
    x.abs().simd_lt(f32x4::splat(4_194_304.0)).select(floor_of_place(x), x)
}

/// Whole numbers 0 ..= 2^22 as such.
#[inline(always)]
fn whole(x: f32x4) -> u32x4 {
    (x + WHOLE).to_bits() - u32x4::splat(WHOLE.to_bits())
}

/// Products with a width or the side of a block: mostly a power of two. (Without SSE 4.1 a product is some twenty instructions.)
#[inline(always)]
pub(crate) fn times(lanes: u32x4, n: u32) -> u32x4 {
    if n.is_power_of_two() { lanes.unbounded_shl_scalar(n.trailing_zeros()) } else { lanes * n }
}

/// A component of normals from its stored form, 0..=255: `v / 127.5 - 1`. Takes filtered values too, as it is linear.
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

    fn wrap(wrap: Wrap) -> Sampler {
        Sampler { wrap: [wrap; 2], filter: Filter::Bilinear }
    }

    fn row(width: u32, mode: Wrap, u: f32) -> (u32, u32, f32) {
        let t = taps(&image(width, 1), &wrap(mode), Filter::Bilinear, [u, 0.5]);
        (t.texel[0][0], t.texel[1][0], t.weight[1] + t.weight[3])
    }

    #[test]
    fn texel_centres_are_hit_exactly_and_edges_wrap() {
        assert_eq!(row(4, Wrap::Repeat, 0.375), (1, 2, 0.0));
        assert_eq!(row(4, Wrap::Repeat, 0.0), (3, 0, 0.5));
        assert_eq!(row(4, Wrap::Repeat, 1.0), (3, 0, 0.5));
        assert_eq!(row(4, Wrap::Repeat, 0.9375), (3, 0, 0.25));
        assert_eq!(row(4, Wrap::Mirror, 0.0), (0, 0, 0.5));
        assert_eq!(row(4, Wrap::Mirror, 1.625), (1, 2, 0.0));
        assert_eq!(row(4, Wrap::Mirror, -0.375), (1, 2, 0.0));
        assert_eq!(row(4, Wrap::Clamp, -3.0), (0, 0, 0.5));
        assert_eq!(row(4, Wrap::Clamp, 9.0), (3, 3, 0.5));
        assert_eq!(row(4, Wrap::Repeat, -0.25), (2, 3, 0.5));
    }

    #[test]
    fn nearest_takes_the_texel_that_holds_the_point() {
        let at = |mode, u| taps(&image(4, 4), &wrap(mode), Filter::Nearest, [u, 0.0]).texel[0][0];
        assert_eq!(at(Wrap::Repeat, 0.49), 1);
        assert_eq!(at(Wrap::Repeat, 0.5), 2);
        assert_eq!(at(Wrap::Repeat, -0.01), 3);
        assert_eq!(at(Wrap::Mirror, 1.01), 3);
        assert_eq!(at(Wrap::Clamp, 7.0), 3);
        assert_eq!(at(Wrap::Clamp, f32::NAN), 0);
    }

    #[test]
    fn normals_decode_to_their_range() {
        assert_eq!(decode_normal(f32x4::new([0.0, 127.5, 255.0, 0.0])).to_array(), [-1.0, 0.0, 1.0, -1.0]);
    }

    fn any_wrap() -> impl Strategy<Value = Wrap> {
        prop_oneof![Just(Wrap::Repeat), Just(Wrap::Mirror), Just(Wrap::Clamp)]
    }

    proptest! {
        #[test]
        fn every_coordinate_lands_inside_with_weights_of_sum_one(
            u in any::<f32>(), v in prop_oneof![any::<f32>(), -3f32..3.0], w in 1u32..70, h in 1u32..70,
            mode in any_wrap(), nearest in any::<bool>(),
        ) {
            let filter = if nearest { Filter::Nearest } else { Filter::Bilinear };
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
        fn taps_equal_a_filter_in_double_precision(u in -4f64..4.0, w in 1u32..70, mode in any_wrap()) {
            let x = f64::from(u as f32) * f64::from(w) - 0.5;
            let fold = |i: i64| {
                let (n, i) = (i64::from(w), i);
                match mode {
                    Wrap::Repeat => i.rem_euclid(n),
                    Wrap::Clamp => i.clamp(0, n - 1),
                    Wrap::Mirror => { let m = i.rem_euclid(2 * n); m.min(2 * n - 1 - m) }
                }
            };
            // The value at a texel is its number: the filtered values must agree although the order may be mirrored.
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
