//! Rotation from tangent space to world space: `N' = T x + B y + N z`, `B = w (N x T)`.

use basrelief_signals::MapInline as _;
use basrelief_signals::StampNormals;
use std::ops::{Add, Mul, Sub};
use wide::f32x4;

/// Computes the cross product `a x b`.
#[inline]
pub(crate) fn cross<F: Copy + Mul<Output = F> + Sub<Output = F>>(a: [F; 3], b: [F; 3]) -> [F; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Tangent frames. The type is generic so that the theorem below is tested in double precision on the code that the unit runs.
/// The unit computes the frames of a stamp side by side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TangentFrame<F> {
    normal: [F; 3],
    tangent: [F; 3],
    bitangent: [F; 3],
}

impl<F: Copy + Add<Output = F> + Mul<Output = F> + Sub<Output = F>> TangentFrame<F> {
    /// Creates the frame from the interpolated normal and tangent, neither normalised again (as MikkTSpace prescribes), and
    /// handedness w.
    #[inline(always)]
    pub(crate) fn new(normal: [F; 3], tangent: [F; 3], w: F) -> Self {
        let [x, y, z] = cross(normal, tangent);
        Self { normal, tangent, bitangent: [x * w, y * w, z * w] }
    }

    /// Transforms the tangent-space vector `v` to the frame's space. Its length does not matter.
    #[inline(always)]
    pub(crate) fn rotate(&self, v: [F; 3]) -> [F; 3] {
        let (t, b, n) = (&self.tangent, &self.bitangent, &self.normal);
        let component = |i: usize| t[i] * v[0] + b[i] * v[1] + n[i] * v[2];
        [component(0), component(1), component(2)]
    }
}

/// Conversion of pseudo-normals to fixed point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FixedPoint {
    /// Steps from 0 to the largest component.
    steps: f32,
    /// Steps of 1/32767 per step.
    widen: f32,
}

impl FixedPoint {
    /// Creates a conversion to components of `bits` bits (8..=16, clamped).
    pub(crate) fn new(bits: u32) -> Self {
        let steps = ((1_i32 << (bits.clamp(8, 16) - 1)) - 1) as f32;
        Self { steps, widen: 32_767.0 / steps }
    }

    /// Returns N' of each lane, scaled so that its largest component is +-32767. The zero vector and vectors without direction
    /// (infinite, not a number) become zero.
    #[inline(always)]
    pub(crate) fn quantize(self, v: [f32x4; 3]) -> StampNormals {
        let [x, y, z] = v;
        // Processors differ in the maximum of a NaN and a number, but the test of the sum finds NaN.
        let largest = x.abs().fast_max(y.abs()).fast_max(z.abs());
        // Below 1e-30 the scale would overflow, but a normal map and unit vectors cannot get there. All tests together: finite,
        // and not too small.
        let sound =
            (x + y + z).abs().simd_le(largest * 3.0) & largest.simd_ge(f32x4::splat(1e-30)) & largest.simd_le(f32x4::splat(1e30));
        let scale = f32x4::splat(self.steps) / largest;
        StampNormals(v.map_inline(|c| {
            let coarse = sound.select(c * scale, f32x4::ZERO);
            let fine = if self.widen == 1.0 { coarse } else { ((coarse + ROUND) - ROUND) * self.widen };
            (fine + ROUND).to_bits().to_array().map_inline(|bits| bits as i16)
        }))
    }
}

/// Added to |c| <= 32767, this number leaves the nearest whole number, half to even, in the low bits of the fraction. A
/// conversion would add range checks.
const ROUND: f32 = 12_582_912.0;

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_signals::StampLanes;
    use proptest::prelude::*;

    /// Returns the quantized vector, computed beside lanes of other vectors.
    fn one(bits: u32, v: [f32; 3]) -> [i16; 3] {
        let beside = v.map(|c| f32x4::new([7.0, f32::NAN, c, 0.0]));
        FixedPoint::new(bits).quantize(beside).lane(2)
    }

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
        // Claim: bump, 1: The bump formula with partial derivatives and the tangent frame give the same N'.
        #[test]
        fn claim_1_bump_formula_equals_tangent_frame(
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
        fn fixed_point_keeps_direction(v in prop::array::uniform3(-1f32..1.0), bits in 8u32..=16) {
            let largest = v.iter().fold(0f32, |m, c| m.max(c.abs()));
            prop_assume!(largest > 1e-3);
            let q = one(bits, v);
            prop_assert_eq!(q.iter().map(|c| c.unsigned_abs()).max(), Some(32_767));
            let step = 32_767.0 / ((1 << (bits - 1)) - 1) as f32;
            for i in 0..3 {
                prop_assert!((f32::from(q[i]) - v[i] / largest * 32_767.0).abs() <= 0.5 * step + 0.52);
            }
        }
    }

    #[test]
    fn vector_without_direction_becomes_zero() {
        let fixed_point = |v: [f32; 3]| one(16, v);
        for v in [[0.0; 3], [1e-40, 0.0, 0.0], [f32::INFINITY, 0.0, 0.0], [f32::NAN, 1.0, 0.0], [f32::NAN; 3]] {
            assert_eq!(fixed_point(v), [0; 3], "{v:?}");
        }
        assert_eq!(fixed_point([-2.0, 1.0, 0.0]), [-32_767, 16_384, 0]);
    }
}
