//! Homogeneous clipping.

use crate::surface::PixelAttributes;
use glam::DVec4;

/// Sides of the guard band, in multiples of the picture's half width and height. They are far enough out that almost nothing is
/// cut. They are near enough that window coordinates stay in the exact range of the rasterizer for any picture up to 32,768
/// pixels wide.
const GUARD: f64 = 8.0;

/// Planes of the clip volume. A vertex is inside if the inner product with its clip position is >= 0. Near and far are those of
/// OpenGL, and together they leave only w >= 0.
const PLANES: [DVec4; 6] = [
    DVec4::new(0.0, 0.0, 1.0, 1.0),
    DVec4::new(0.0, 0.0, -1.0, 1.0),
    DVec4::new(1.0, 0.0, 0.0, GUARD),
    DVec4::new(-1.0, 0.0, 0.0, GUARD),
    DVec4::new(0.0, 1.0, 0.0, GUARD),
    DVec4::new(0.0, -1.0, 0.0, GUARD),
];

/// A vertex in clip space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClipVertex {
    pub position: DVec4,
    pub attributes: PixelAttributes,
}

impl AsMut<PixelAttributes> for ClipVertex {
    fn as_mut(&mut self) -> &mut PixelAttributes {
        &mut self.attributes
    }
}

/// Returns true if a vertex lies inside all planes.
pub(crate) fn inside(vertex: &ClipVertex) -> bool {
    PLANES.iter().all(|plane| plane.dot(vertex.position) >= 0.0)
}

/// Returns the part of a triangle inside all planes: a convex polygon, with fewer than three vertices if no part is inside.
pub(crate) fn clipped(triangle: [ClipVertex; 3]) -> Vec<ClipVertex> {
    let mut polygon = triangle.to_vec();
    for plane in PLANES {
        polygon = cut(&polygon, plane);
    }
    polygon
}

/// Clips a polygon at one plane (Sutherland-Hodgman).
fn cut(polygon: &[ClipVertex], plane: DVec4) -> Vec<ClipVertex> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    let followers = polygon.iter().cycle().skip(1);
    for (from, to) in polygon.iter().zip(followers) {
        let (start, end) = (plane.dot(from.position), plane.dot(to.position));
        if start >= 0.0 {
            kept.push(*from);
        }
        // Always computed from the inner to the outer end, so that both triangles of an edge get the same point.
        if start >= 0.0 && end < 0.0 {
            kept.push(between(from, to, start / (start - end)));
        } else if start < 0.0 && end >= 0.0 {
            kept.push(between(to, from, end / (end - start)));
        }
    }
    kept
}

fn between(from: &ClipVertex, to: &ClipVertex, share: f64) -> ClipVertex {
    ClipVertex {
        position: from.position + (to.position - from.position) * share,
        attributes: PixelAttributes::weighted([&from.attributes, &to.attributes], [1.0 - share, share]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vertex([x, y, z, w]: [f64; 4]) -> ClipVertex {
        ClipVertex { position: DVec4::new(x, y, z, w), attributes: PixelAttributes::default() }
    }

    #[test]
    fn inner_triangle_is_kept_and_outer_one_is_dropped() {
        let inner = [[0.0, 0.0, 0.0, 1.0], [0.5, 0.0, 0.2, 1.0], [0.0, 0.5, -0.9, 1.0]].map(vertex);
        assert!(inner.iter().all(inside));
        assert_eq!(clipped(inner).len(), 3);
        let behind = [[0.0, 0.0, 0.0, -1.0], [0.5, 0.0, 0.0, -1.0], [0.0, 0.5, 0.0, -1.0]].map(vertex);
        assert!(clipped(behind).len() < 3);
    }

    proptest! {
        #[test]
        fn clipped_polygon_lies_inside(values in prop::array::uniform3(prop::array::uniform4(-20.0..20.0f64))) {
            let polygon = clipped(values.map(vertex));
            prop_assert!(polygon.len() <= 9);
            for vertex in polygon {
                prop_assert!(vertex.position.w >= -1e-9);
                prop_assert!(PLANES.iter().all(|plane| plane.dot(vertex.position) >= -1e-9));
            }
        }
    }
}
