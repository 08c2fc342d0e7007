//! Arithmetic of limited width: what it makes of a number, and how long it takes.

/// Bits of the significand of double precision.
const SIGNIFICAND: u32 = 53;

/// Cycles of an iterative divider or root whose result has so many bits. Radix 4 finds two of them per cycle.
pub fn iterations(bits: u32, bits_per_cycle: u32) -> u32 {
    bits.div_ceil(bits_per_cycle.max(1)).max(1)
}

/// The number with so many significant bits, rounded to the nearest; one half way, away from 0.
#[inline]
pub(crate) fn nearest(x: f64, bits: u32) -> f64 {
    let dropped = SIGNIFICAND.saturating_sub(bits);
    let half = if dropped == 0 { 0 } else { 1u64 << (dropped - 1) };
    // A carry out of the significand belongs into the exponent, which is beside it.
    down(f64::from_bits(x.to_bits().wrapping_add(half)), bits)
}

/// The number with so many significant bits, rounded towards 0.
#[inline]
pub(crate) fn down(x: f64, bits: u32) -> f64 {
    let dropped = SIGNIFICAND.saturating_sub(bits).min(SIGNIFICAND - 1);
    f64::from_bits(x.to_bits() >> dropped << dropped)
}

/// u or v, |u| <= 1, in fixed point of so many bits with the sign: in steps of 2^-(bits - 1), to the nearest, saturated.
#[inline]
pub(crate) fn to_fixed(x: f64, bits: u32) -> i64 {
    let one = 1i64 << (bits - 1);
    ((x * one as f64 + 0.5).floor() as i64).clamp(1 - one, one - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quotient_of_w_bits_takes_half_as_many_cycles_in_radix_4() {
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
