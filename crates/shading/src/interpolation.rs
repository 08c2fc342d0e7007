//! Interpolation of the attributes of a fragment over its triangle.

use basrelief_signals::{Fragment, Polygon, Stamp, Vertex};
use basrelief_signals::{MapInline as _, from_fn_inline};
use wide::f32x4;

/// Returns the vertices of triangle `triangle` of the polygon's fan: 0, `triangle + 1`, `triangle + 2`. Returns `None` if the
/// polygon has fewer.
#[inline]
pub fn fan_triangle(polygon: &Polygon, triangle: u16) -> Option<[&Vertex; 3]> {
    let i = usize::from(triangle);
    Some([polygon.vertices.first()?, polygon.vertices.get(i + 1)?, polygon.vertices.get(i + 2)?])
}

/// Attributes over a triangle: the value at the first vertex, and the differences of the other two from it.
///
/// The `N` attributes lie side by side, so that the compiler can use vector registers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttributeGradient<const N: usize> {
    first: [f32; N],
    second: [f32; N],
    third: [f32; N],
}

impl<const N: usize> AttributeGradient<N> {
    /// Creates the gradient from the attributes of the three vertices.
    #[inline]
    pub fn new([a, b, c]: [&[f32; N]; 3]) -> Self {
        let less = |p: &[f32; N]| from_fn_inline(|i| p[i] - a[i]);
        Self { first: *a, second: less(b), third: less(c) }
    }

    /// Returns the attributes at perspective-correct `weights` of the second and third vertex: `a + w1 (b - a) + w2 (c - a)`. An
    /// attribute that is constant over the triangle stays constant to the bit.
    #[inline]
    pub fn at(&self, weights: [f32; 2]) -> [f32; N] {
        from_fn_inline(|i| self.first[i] + weights[0] * self.second[i] + weights[1] * self.third[i])
    }

    /// Computes [`AttributeGradient::at`] for four fragments side by side.
    #[inline(always)]
    pub fn side_by_side(&self, [second, third]: [f32x4; 2]) -> [f32x4; N] {
        let mut attributes = [f32x4::ZERO; N];
        for (i, attribute) in attributes.iter_mut().enumerate() {
            *attribute = second * self.second[i] + self.first[i] + third * self.third[i];
        }
        attributes
    }
}

/// Returns two values of each entry of a stamp, side by side. Lanes without an entry repeat the last one: a mask would cost
/// more than the wasted arithmetic. (An array filled in steps would be slower: the processor cannot load the register before all
/// stores to it are in memory.)
#[inline(always)]
pub fn side_by_side<T>(stamp: &Stamp<T>, values: impl Fn(&T) -> [f32; 2]) -> [f32x4; 2] {
    let Some(last) = stamp.len().checked_sub(1) else { return [f32x4::ZERO; 2] };
    let [a, b, c, d] = [0, 1, 2, 3].map_inline(|lane: usize| values(&stamp[lane.min(last)]));
    [f32x4::new([a[0], b[0], c[0], d[0]]), f32x4::new([a[1], b[1], c[1], d[1]])]
}

/// Returns the weights of the fragments of a stamp, side by side.
#[inline(always)]
pub fn weights(stamp: &Stamp<Fragment>) -> [f32x4; 2] {
    side_by_side(stamp, |fragment| fragment.weights)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn corners_and_constants_are_exact() {
        let v = [[1.0, 0.1], [2.0, 0.1], [4.0, 0.1]];
        let at = |w| AttributeGradient::new([&v[0], &v[1], &v[2]]).at(w);
        assert_eq!(at([0.0, 0.0]), v[0]);
        assert_eq!(at([1.0, 0.0]), v[1]);
        assert_eq!(at([0.0, 1.0]), v[2]);
        assert_eq!(at([0.3, 0.17])[1], 0.1);
        let weights = [[0.3, 1.0, 0.0, 0.5], [0.17, 0.0, 0.0, 0.5]];
        let side_by_side = AttributeGradient::new([&v[0], &v[1], &v[2]]).side_by_side(weights.map(f32x4::new));
        for lane in 0..4 {
            assert_eq!(side_by_side.map(|a| a.to_array()[lane]), at(weights.map(|w| w[lane])));
        }
    }

    #[test]
    fn fan_ends_with_last_vertex() {
        let polygon =
            Polygon { vertices: vec![Vertex::default(); 5], material: Arc::default(), object: 0, lod: 0, bump: true, arrival: 0 };
        assert!(fan_triangle(&polygon, 2).is_some());
        assert!(fan_triangle(&polygon, 3).is_none());
        assert!(fan_triangle(&polygon, u16::MAX).is_none());
    }
}
