//! The fragments of a stamp side by side: one per lane of a vector register.

use basrelief_shading::LANES;
use basrelief_signals::{Fragment, MAX_STAMP, Stamp};
use wide::f32x4;

const _: () = assert!(LANES == MAX_STAMP, "a stamp has a lane for each of its fragments");

/// Weights of the fragments of a stamp. Lanes without a fragment repeat its first: a mask would cost more than what they
/// compute in vain.
#[inline(always)]
pub(crate) fn weights(stamp: &Stamp<Fragment>) -> [f32x4; 2] {
    let mut weights = stamp.first().map_or([[0.0; MAX_STAMP]; 2], |first| first.weights.map(|weight| [weight; MAX_STAMP]));
    for (lane, fragment) in stamp.iter().enumerate().skip(1) {
        [weights[0][lane], weights[1][lane]] = fragment.weights;
    }
    weights.map(f32x4::new)
}
