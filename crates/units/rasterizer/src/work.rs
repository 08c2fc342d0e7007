//! What arithmetic a triangle and a fragment take; it is done in [`basrelief_shading::scan`].

use basrelief_kernel::Work;

/// Set-up of a triangle.
///
/// - Three edge functions: two differences each, and the value at the origin of two products and a sum; twice the area is the
///   sum of the three.
/// - A reciprocal of the area.
/// - Depth and 1 / w of each corner per unit of its edge function: a product each with the reciprocal.
/// - The box around: two comparisons for each of four sides.
pub(crate) const SET_UP: Work = Work { multiply: 3 * 2 + 3 * 2, add: 3 * 3 + 2 + 4 * 2, divide: 1, ..Work::NONE };
/// What of this waits for each other: difference, product, sums, reciprocal, product.
const SET_UP_CHAIN: Work = Work { multiply: 2, add: 4, divide: 1, ..Work::NONE };

/// A fragment.
///
/// - Three edge functions go on by a step each, and are compared with zero.
/// - Depth: the three times their factors, summed and rounded.
/// - Perspective: the three times 1 / w, their sum and its reciprocal, two weights.
pub(crate) const FRAGMENT: Work = Work { multiply: 3 + 3 + 2, add: 3 * 2 + 3 + 2, divide: 1, ..Work::NONE };
/// What of this waits for each other: step, product, two sums, reciprocal, product.
const FRAGMENT_CHAIN: Work = Work { multiply: 2, add: 3, divide: 1, ..Work::NONE };

/// From a polygon to its first fragment: both, one after the other. Control and fragments take the same way, so as to stay in
/// order.
pub(crate) const CHAIN: Work = SET_UP_CHAIN.and(FRAGMENT_CHAIN);

/// What set-up leaves for the fragments: steps and values of three edges, depth and 1 / w at three corners, sides of the box
/// \[numbers\].
pub(crate) const SET_UP_NUMBERS: u32 = 3 * 3 + 3 + 3 + 4;
