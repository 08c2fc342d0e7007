//! Eight numbers in the lanes of an AVX2 register. Comparisons return masks: lanes of all ones or all zeros.

use pulp::cast;
use pulp::x86::V3;
use std::arch::x86_64::{__m128i, __m256, __m256i, _CMP_GE_OQ, _CMP_GT_OQ, _CMP_LE_OQ, _CMP_LT_OQ};
use std::array;
use std::ops::{Add, BitAnd, Div, Mul, Sub};

/// Number of lanes.
pub(crate) const LANES: usize = 8;
/// A float of this size has no bits below 1, so that adding it rounds a small number to a whole one.
const ROUNDING: f32 = 12_582_912.0;

/// Eight floats.
#[derive(Clone, Copy)]
pub(crate) struct F32x8 {
    simd: V3,
    pub(crate) lanes: __m256,
}

/// Eight integers.
#[derive(Clone, Copy)]
pub(crate) struct I32x8 {
    simd: V3,
    pub(crate) lanes: __m256i,
}

/// Implements an operator between lanes, and between lanes and one number.
macro_rules! operator {
    ($lanes:ident, $number:ident, $operator:ident, $name:ident, $feature:ident, $instruction:ident) => {
        impl $operator for $lanes {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                self.with(self.simd.$feature.$instruction(self.lanes, other.lanes))
            }
        }
        impl $operator<$number> for $lanes {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: $number) -> Self {
                $operator::$name(self, Self::splat(self.simd, other))
            }
        }
    };
}

operator!(F32x8, f32, Add, add, avx, _mm256_add_ps);
operator!(F32x8, f32, Sub, sub, avx, _mm256_sub_ps);
operator!(F32x8, f32, Mul, mul, avx, _mm256_mul_ps);
operator!(F32x8, f32, Div, div, avx, _mm256_div_ps);
operator!(F32x8, f32, BitAnd, bitand, avx, _mm256_and_ps);
operator!(I32x8, i32, Add, add, avx2, _mm256_add_epi32);
operator!(I32x8, i32, Sub, sub, avx2, _mm256_sub_epi32);
operator!(I32x8, i32, BitAnd, bitand, avx2, _mm256_and_si256);

impl F32x8 {
    #[inline(always)]
    pub(crate) fn new(simd: V3, lanes: __m256) -> Self {
        Self { simd, lanes }
    }

    #[inline(always)]
    pub(crate) fn splat(simd: V3, number: f32) -> Self {
        Self::new(simd, simd.avx._mm256_set1_ps(number))
    }

    /// Reads the eight numbers at the start of a slice.
    #[inline(always)]
    pub(crate) fn read(simd: V3, numbers: &[f32]) -> Self {
        let eight: [f32; LANES] = array::from_fn(|i| numbers[..LANES][i]);
        Self::new(simd, cast(eight))
    }

    #[inline(always)]
    pub(crate) fn to_array(self) -> [f32; LANES] {
        cast(self.lanes)
    }

    #[inline(always)]
    fn with(self, lanes: __m256) -> Self {
        Self { lanes, ..self }
    }

    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        self.with(self.simd.avx._mm256_max_ps(self.lanes, other.lanes))
    }

    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        self.with(self.simd.avx._mm256_min_ps(self.lanes, other.lanes))
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        self.with(self.simd.avx._mm256_andnot_ps(self.simd.avx._mm256_set1_ps(-0.0), self.lanes))
    }

    #[inline(always)]
    pub(crate) fn ge(self, other: Self) -> Self {
        self.with(self.simd.avx._mm256_cmp_ps::<_CMP_GE_OQ>(self.lanes, other.lanes))
    }

    #[inline(always)]
    pub(crate) fn gt(self, other: Self) -> Self {
        self.with(self.simd.avx._mm256_cmp_ps::<_CMP_GT_OQ>(self.lanes, other.lanes))
    }

    #[inline(always)]
    pub(crate) fn le(self, other: Self) -> Self {
        self.with(self.simd.avx._mm256_cmp_ps::<_CMP_LE_OQ>(self.lanes, other.lanes))
    }

    #[inline(always)]
    pub(crate) fn lt(self, other: Self) -> Self {
        self.with(self.simd.avx._mm256_cmp_ps::<_CMP_LT_OQ>(self.lanes, other.lanes))
    }

    /// Selects lanes by a mask.
    #[inline(always)]
    pub(crate) fn select(self, set: Self, clear: Self) -> Self {
        self.with(self.simd.avx._mm256_blendv_ps(clear.lanes, set.lanes, self.lanes))
    }

    /// Rounds small numbers to whole ones.
    #[inline(always)]
    pub(crate) fn round(self) -> Self {
        (self + ROUNDING) - ROUNDING
    }

    /// Rounds small numbers to integers.
    #[inline(always)]
    pub(crate) fn round_to_int(self) -> I32x8 {
        let bits = I32x8::new(self.simd, self.simd.avx._mm256_castps_si256((self + ROUNDING).lanes));
        bits - ROUNDING.to_bits().cast_signed()
    }

    /// Rounds down small numbers.
    #[inline(always)]
    pub(crate) fn small_floor(self) -> Self {
        let whole = self.round();
        whole - (whole.gt(self) & 1.0)
    }

    /// Rounds down.
    #[inline(always)]
    pub(crate) fn floor(self) -> Self {
        let is_small = self.abs().lt(Self::splat(self.simd, 4_194_304.0));
        is_small.select(self.small_floor(), self)
    }

    /// Truncates to integers.
    #[inline(always)]
    pub(crate) fn truncate(self) -> I32x8 {
        I32x8::new(self.simd, self.simd.avx._mm256_cvttps_epi32(self.lanes))
    }
}

impl I32x8 {
    #[inline(always)]
    pub(crate) fn new(simd: V3, lanes: __m256i) -> Self {
        Self { simd, lanes }
    }

    #[inline(always)]
    pub(crate) fn splat(simd: V3, number: i32) -> Self {
        Self::new(simd, simd.avx._mm256_set1_epi32(number))
    }

    #[inline(always)]
    fn with(self, lanes: __m256i) -> Self {
        Self { lanes, ..self }
    }

    #[inline(always)]
    pub(crate) fn to_array(self) -> [i32; LANES] {
        cast(self.lanes)
    }

    #[inline(always)]
    pub(crate) fn to_floats(self) -> F32x8 {
        F32x8::new(self.simd, self.simd.avx._mm256_cvtepi32_ps(self.lanes))
    }

    /// Shifts left by one number for all lanes.
    #[inline(always)]
    pub(crate) fn shift_left(self, bits: u32) -> Self {
        let count: __m128i = cast([u64::from(bits), 0]);
        self.with(self.simd.avx2._mm256_sll_epi32(self.lanes, count))
    }

    /// Shifts right, filling with zeros.
    #[inline(always)]
    pub(crate) fn shift_right<const BITS: i32>(self) -> Self {
        self.with(self.simd.avx2._mm256_srli_epi32::<BITS>(self.lanes))
    }

    /// Keeps the low 16 bits, and extends their sign.
    #[inline(always)]
    pub(crate) fn sign_extend_16(self) -> Self {
        let high = self.simd.avx2._mm256_slli_epi32::<16>(self.lanes);
        self.with(self.simd.avx2._mm256_srai_epi32::<16>(high))
    }
}
