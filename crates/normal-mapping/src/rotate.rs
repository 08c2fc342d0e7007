//! From tangent space to the world: `N' = T x + B y + N z`, `B = w (N x T)`.

use std::ops::{Add, Mul, Sub};

/// `a x b`.
#[inline]
pub(crate) fn cross<F: Copy + Mul<Output = F> + Sub<Output = F>>(a: [F; 3], b: [F; 3]) -> [F; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Tangent frame of a fragment. Generic so that the theorem below is tested on the code that the unit runs, in double
/// precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TangentFrame<F> {
    normal: [F; 3],
    tangent: [F; 3],
    bitangent: [F; 3],
}

impl<F: Copy + Add<Output = F> + Mul<Output = F> + Sub<Output = F>> TangentFrame<F> {
    /// From the interpolated normal and tangent, neither normalised again (as MikkTSpace prescribes), and handedness w.
    #[inline]
    pub(crate) fn new(normal: [F; 3], tangent: [F; 3], w: F) -> Self {
        Self { normal, tangent, bitangent: cross(normal, tangent).map(|c| c * w) }
    }

    /// The tangent-space vector `v` in the frame's space; its length does not matter.
    #[inline]
    pub(crate) fn rotate(&self, v: [F; 3]) -> [F; 3] {
        std::array::from_fn(|i| self.tangent[i] * v[0] + self.bitangent[i] * v[1] + self.normal[i] * v[2])
    }
}

/// N' in fixed point: its largest component is +-32767, each quantized to `bits` (8..=16); the zero vector and what has
/// no direction (infinite, not a number) become zero.
#[inline]
pub(crate) fn fixed_point(v: [f32; 3], bits: u32) -> [i16; 3] {
    let largest = v[0].abs().max(v[1].abs()).max(v[2].abs());
    // Below 1e-30 the scale would overflow; a normal map and unit vectors cannot get there. `max` drops a NaN, a sum
    // does not.
    if !((1e-30..=f32::MAX).contains(&largest) && (v[0] + v[1] + v[2]).is_finite()) {
        return [0; 3];
    }
    let steps = ((1_i32 << (bits.clamp(8, 16) - 1)) - 1) as f32;
    let scale = steps / largest;
    let quantized = v.map(|c| round(c * scale));
    if bits >= 16 { quantized } else { quantized.map(|q| round(f32::from(q) * (32_767.0 / steps))) }
}

/// Nearest whole number, half to even, of |c| <= 32767. The sum leaves it in the low bits of the fraction: a conversion
/// would cost the checks for what does not fit, three times per sample.
#[inline]
fn round(c: f32) -> i16 {
    (c + 12_582_912.0).to_bits() as i16
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }

    fn scaled(a: [f64; 3], s: f64) -> [f64; 3] {
        a.map(|c| c * s)
    }

    fn sum(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| a[i] + b[i])
    }

    fn unit(a: [f64; 3]) -> [f64; 3] {
        scaled(a, 1.0 / dot(a, a).sqrt())
    }

    /// The patent's `N' = N + D`, `D = w {Bu (N x Pt) - Bv (N x Ps)} / |N|` with Ps = T, Pt = w (N x T).
    fn bump_formula(n: [f64; 3], t: [f64; 3], w: f64, bu: f64, bv: f64) -> [f64; 3] {
        let (ps, pt) = (t, scaled(cross(n, t), w));
        let d = sum(scaled(cross(n, pt), w * bu), scaled(cross(n, ps), -w * bv));
        sum(n, scaled(d, 1.0 / dot(n, n).sqrt()))
    }

    proptest! {
        #[test]
        fn claim_1_the_bump_formula_and_the_tangent_frame_agree(
            a in prop::array::uniform3(-1f64..1.0), b in prop::array::uniform3(-1f64..1.0),
            left in any::<bool>(), bu in -4f64..4.0, bv in -4f64..4.0,
        ) {
            prop_assume!(dot(a, a) > 0.01 && dot(cross(a, b), cross(a, b)) > 0.01);
            let n = unit(a);
            let t = unit(sum(b, scaled(n, -dot(n, b))));
            let w = if left { -1.0 } else { 1.0 };
            let by_formula = unit(bump_formula(n, t, w, bu, bv));
            let by_frame = TangentFrame::new(n, t, w).rotate(unit([-bu, -bv, 1.0]));
            for i in 0..3 {
                prop_assert!((by_formula[i] - by_frame[i]).abs() < 1e-14, "{by_formula:?} {by_frame:?}");
            }
        }

        #[test]
        fn fixed_point_keeps_the_direction(v in prop::array::uniform3(-1f32..1.0), bits in 8u32..=16) {
            let largest = v.iter().fold(0f32, |m, c| m.max(c.abs()));
            prop_assume!(largest > 1e-3);
            let q = fixed_point(v, bits);
            prop_assert_eq!(q.iter().map(|c| c.unsigned_abs()).max(), Some(32_767));
            let step = 32_767.0 / ((1 << (bits - 1)) - 1) as f32;
            for i in 0..3 {
                prop_assert!((f32::from(q[i]) - v[i] / largest * 32_767.0).abs() <= 0.5 * step + 0.52);
            }
        }
    }

    #[test]
    fn what_has_no_direction_is_zero() {
        for v in [[0.0; 3], [1e-40, 0.0, 0.0], [f32::INFINITY, 0.0, 0.0], [f32::NAN, 1.0, 0.0]] {
            assert_eq!(fixed_point(v, 16), [0; 3], "{v:?}");
        }
        assert_eq!(fixed_point([-2.0, 1.0, 0.0], 16), [-32_767, 16_384, 0]);
    }
}
