//! Arithmetic of a triangle and of a fragment. [`basrelief_shading::scan`] performs it.

use basrelief_kernel::OperatorCounts;

/// Arithmetic of the set-up of a triangle.
///
/// - Three edge functions: two differences each, and the value at the origin of two products and a sum. Twice the area is the sum
///   of the three.
/// - A reciprocal of the area.
/// - Depth and 1 / w of each corner per unit of its edge function: a product each with the reciprocal.
/// - The bounding box: two comparisons for each of four sides.
pub(crate) const SET_UP: OperatorCounts =
    OperatorCounts { multiply: 3 * 2 + 3 * 2, add: 3 * 3 + 2 + 4 * 2, divide: 1, ..OperatorCounts::NONE };
/// Longest dependent chain of the set-up: difference, product, sums, reciprocal, product.
const SET_UP_CHAIN: OperatorCounts = OperatorCounts { multiply: 2, add: 4, divide: 1, ..OperatorCounts::NONE };

/// Arithmetic of a fragment.
///
/// - Three edge functions advance by a step each, and are compared with zero.
/// - Depth: the three functions times their factors, summed and rounded.
/// - Perspective: the three functions times 1 / w, their sum and its reciprocal, two weights.
pub(crate) const FRAGMENT: OperatorCounts =
    OperatorCounts { multiply: 3 + 3 + 2, add: 3 * 2 + 3 + 2, divide: 1, ..OperatorCounts::NONE };
/// Longest dependent chain of a fragment: step, product, two sums, reciprocal, product.
const FRAGMENT_CHAIN: OperatorCounts = OperatorCounts { multiply: 2, add: 3, divide: 1, ..OperatorCounts::NONE };

/// Longest dependent chain from a polygon to its first fragment: both, one after the other. Control and fragments have the same
/// latency, so that they stay in order.
pub(crate) const CHAIN: OperatorCounts = SET_UP_CHAIN.and(FRAGMENT_CHAIN);

/// Numbers that the set-up stores for the fragments: steps and values of three edges, depth and 1 / w at three corners, sides of
/// the box.
pub(crate) const SET_UP_NUMBERS: u32 = 3 * 3 + 3 + 3 + 4;
