//! From tangent space to the world: `N' = T x + B y + N z`, `B = w (N x T)`.

use std::ops::{Add, Mul, Sub};

/// `a x b`.
#[inline]
pub(crate) fn cross<F: Copy + Mul<Output = F> + Sub<Output = F>>(a: [F; 3], b: [F; 3]) -> [F; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Tangent frame of a fragment. Generic so that the theorem below is tested on the code that the unit runs, in double
/// precision; of four lanes, the last one idle, as vector registers have four.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TangentFrame<F> {
    normal: [F; 4],
    tangent: [F; 4],
    bitangent: [F; 4],
}

impl<F: Copy + Default + Add<Output = F> + Mul<Output = F> + Sub<Output = F>> TangentFrame<F> {
    /// From the interpolated normal and tangent, neither normalised again (as MikkTSpace prescribes), and handedness w.
    #[inline]
    pub(crate) fn new(normal: [F; 3], tangent: [F; 3], w: F) -> Self {
        let lanes = |[x, y, z]: [F; 3]| [x, y, z, F::default()];
        let [x, y, z] = cross(normal, tangent);
        Self { normal: lanes(normal), tangent: lanes(tangent), bitangent: lanes([x * w, y * w, z * w]) }
    }

    /// The tangent-space vector `v` in the frame's space; its length does not matter.
    #[inline]
    pub(crate) fn rotate(&self, v: [F; 3]) -> [F; 4] {
        let (t, b, n) = (&self.tangent, &self.bitangent, &self.normal);
        let lane = |i: usize| t[i] * v[0] + b[i] * v[1] + n[i] * v[2];
        [lane(0), lane(1), lane(2), lane(3)]
    }
}

/// Pseudo-normals in fixed point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FixedPoint {
    /// Steps from 0 to the largest component.
    steps: f32,
    /// Steps of 1/32767 per step.
    widen: f32,
}

impl FixedPoint {
    /// Components of `bits` bits (8..=16, clamped).
    pub(crate) fn new(bits: u32) -> Self {
        let steps = ((1_i32 << (bits.clamp(8, 16) - 1)) - 1) as f32;
        Self { steps, widen: 32_767.0 / steps }
    }

    /// N' so that its largest component is +-32767; the zero vector and what has no direction (infinite, not a number)
    /// become zero. The fourth lane is idle.
    #[inline]
    pub(crate) fn quantize(self, v: [f32; 4]) -> [i16; 3] {
        // Not `f32::max`, which spends six instructions on NaN: the sum below finds those.
        let larger = |a: f32, b: f32| if a > b { a } else { b };
        let largest = larger(larger(v[0].abs(), v[1].abs()), v[2].abs());
        let scale = self.steps / largest;
        // A NaN among them a comparison may drop, a sum does not. Below 1e-30 the scale would overflow; a normal map and unit vectors
        // cannot get there. Together: finite, and not too small.
        let sound = (v[0] + v[1] + v[2]).abs() <= 3.0 * largest && (1e-30..=1e30).contains(&largest);
        if !sound {
            return [0; 3];
        }
        let coarse = [round(v[0] * scale), round(v[1] * scale), round(v[2] * scale)];
        if self.widen == 1.0 { coarse } else { coarse.map(|q| round(f32::from(q) * self.widen)) }
    }
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
            let q = FixedPoint::new(bits).quantize([v[0], v[1], v[2], 0.0]);
            prop_assert_eq!(q.iter().map(|c| c.unsigned_abs()).max(), Some(32_767));
            let step = 32_767.0 / ((1 << (bits - 1)) - 1) as f32;
            for i in 0..3 {
                prop_assert!((f32::from(q[i]) - v[i] / largest * 32_767.0).abs() <= 0.5 * step + 0.52);
            }
        }
    }

    #[test]
    fn what_has_no_direction_is_zero() {
        let fixed_point = |[x, y, z]: [f32; 3]| FixedPoint::new(16).quantize([x, y, z, 0.0]);
        for v in [[0.0; 3], [1e-40, 0.0, 0.0], [f32::INFINITY, 0.0, 0.0], [f32::NAN, 1.0, 0.0], [f32::NAN; 3]] {
            assert_eq!(fixed_point(v), [0; 3], "{v:?}");
        }
        assert_eq!(fixed_point([-2.0, 1.0, 0.0]), [-32_767, 16_384, 0]);
    }
}
