//! Arithmetic of limited width: its results and its cycles.

/// Bits of the significand of double precision.
const SIGNIFICAND: u32 = 53;

/// Returns the cycles of an iterative divider or root with a result of `bits` bits. Radix 4 computes two bits per cycle.
pub fn iterations(bits: u32, bits_per_cycle: u32) -> u32 {
    bits.div_ceil(bits_per_cycle.max(1)).max(1)
}

/// Rounds a number to the nearest with `bits` significant bits. Ties round away from 0.
#[inline]
pub(crate) fn nearest(x: f64, bits: u32) -> f64 {
    let dropped = SIGNIFICAND.saturating_sub(bits);
    let half = if dropped == 0 { 0 } else { 1u64 << (dropped - 1) };
    // A carry out of the significand continues into the exponent, which is next to it.
    down(f64::from_bits(x.to_bits().wrapping_add(half)), bits)
}

/// Rounds a number towards 0 with `bits` significant bits.
#[inline]
pub(crate) fn down(x: f64, bits: u32) -> f64 {
    let dropped = SIGNIFICAND.saturating_sub(bits).min(SIGNIFICAND - 1);
    f64::from_bits(x.to_bits() >> dropped << dropped)
}

/// Converts u or v, |u| <= 1, to signed fixed point of `bits` bits: in steps of 2^-(bits - 1), to the nearest, saturated.
#[inline]
pub(crate) fn to_fixed(x: f64, bits: u32) -> i64 {
    let one = 1i64 << (bits - 1);
    ((x * one as f64 + 0.5).floor() as i64).clamp(1 - one, one - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radix_4_computes_two_bits_per_cycle() {
        assert_eq!([1, 16, 31, 32].map(|bits| iterations(bits, 2)), [1, 8, 16, 16]);
        assert_eq!([1, 16, 31, 32].map(|bits| iterations(bits, 1)), [1, 16, 31, 32]);
    }

    #[test]
    fn significant_bits_are_rounded() {
        assert_eq!([5.0, 5.5, 11.0, 15.0, -15.0].map(|x| nearest(x, 3)), [5.0, 6.0, 12.0, 16.0, -16.0]);
        assert_eq!([5.0, 5.5, 11.0, 15.0, -15.0].map(|x| down(x, 3)), [5.0, 5.0, 10.0, 14.0, -14.0]);
        assert_eq!([nearest(0.1, 53), down(0.1, 53), nearest(0.0, 8)], [0.1, 0.1, 0.0]);
        assert_eq!(nearest(f64::INFINITY, 8), f64::INFINITY);
    }

    #[test]
    fn fixed_point_saturates() {
        assert_eq!([0.0, 0.5, -0.5, 0.124, 1.0, -1.0].map(|x| to_fixed(x, 4)), [0, 4, -4, 1, 7, -7]);
        assert_eq!([f64::NAN, f64::INFINITY].map(|x| to_fixed(x, 4)), [0, 7]);
    }
}
