//! Polygons to triangles.

use glam::DVec3;

/// Maximum number of corners of a concave polygon: the time to cut it grows with their square.
pub(super) const MOST_CONCAVE_CORNERS: usize = 4096;

/// Allowed turn of a corner the wrong way in a convex polygon, relative to the polygon's area, because of rounding.
const TURN_TOLERANCE: f64 = 1e-9;

/// Vector along the normal of a polygon, of twice its area (Newell's method).
pub(super) fn area_vector(points: &[DVec3]) -> DVec3 {
    let Some(first) = points.first().copied() else { return DVec3::ZERO };
    points.windows(2).map(|pair| (pair[0] - first).cross(pair[1] - first)).sum()
}

/// True if no corner turns against the others.
pub(super) fn is_convex(points: &[DVec3]) -> bool {
    let area = area_vector(points);
    let corners = points.iter().zip(points.iter().cycle().skip(1)).zip(points.iter().cycle().skip(2));
    let limit = -TURN_TOLERANCE * area.length_squared();
    points.len() < 4 || corners.into_iter().all(|((a, b), c)| (*b - *a).cross(*c - *b).dot(area) >= limit)
}

/// Triangles of a polygon, as numbers of its corners. A convex one becomes a fan about its first corner.
pub(super) fn triangulate(points: &[DVec3], triangles: &mut Vec<[u32; 3]>) {
    triangles.clear();
    if !is_convex(points) {
        let mut corners: Vec<u32> = Vec::new();
        earcut::Earcut::new().earcut(flattened(points), &[], &mut corners);
        triangles.extend_from_slice(corners.as_chunks().0);
    }
    // A polygon without area has no ears.
    if triangles.is_empty() {
        triangles.extend((2..points.len() as u32).map(|corner| [0, corner - 1, corner]));
    }
}

/// The polygon without the coordinate along which it is thinnest, counter-clockwise.
fn flattened(points: &[DVec3]) -> impl Iterator<Item = [f64; 2]> {
    let area = area_vector(points);
    let axis = area.abs().max_position();
    let axes = [(axis + 1) % 3, (axis + 2) % 3];
    let [u, v] = if area[axis] < 0.0 { [axes[1], axes[0]] } else { axes };
    points.iter().map(move |point| [point[u], point[v]])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(points: &[DVec3]) -> Vec<[u32; 3]> {
        let mut triangles = Vec::new();
        triangulate(points, &mut triangles);
        triangles
    }

    /// Sum of the triangles' areas, and of the part of them that faces as the polygon does.
    fn areas(points: &[DVec3]) -> [f64; 2] {
        let normal = area_vector(points).normalize();
        let triangles = cut(points);
        let of = |t: &[u32; 3]| area_vector(&t.map(|i| points[i as usize]));
        [triangles.iter().map(|t| of(t).length() / 2.0).sum(), triangles.iter().map(|t| of(t).dot(normal) / 2.0).sum()]
    }

    /// An L of area 3 from each of its corners, in every plane, from both sides.
    #[test]
    fn concave_polygon_is_covered_once_from_any_corner() {
        let l = [[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]];
        for first in 0..6 {
            for plane in 0..3 {
                for mirrored in [false, true] {
                    let mut points: Vec<DVec3> = (0..6)
                        .map(|i| {
                            let [u, v] = l[(i + first) % 6];
                            let mut point = DVec3::ZERO;
                            (point[plane], point[(plane + 1) % 3], point[(plane + 2) % 3]) = (u, v, 0.3 * u);
                            point
                        })
                        .collect();
                    if mirrored {
                        points.reverse();
                    }
                    let slope = (1.0 + 0.3 * 0.3f64).sqrt();
                    for area in areas(&points) {
                        assert!((area - 3.0 * slope).abs() < 1e-12, "{first} {plane} {mirrored}: {area}");
                    }
                }
            }
        }
    }

    #[test]
    fn convex_polygon_becomes_a_fan() {
        let square = [[0., 0.], [1., 0.], [1., 1.], [0., 1.]].map(|[x, y]| DVec3::new(x, y, 0.0));
        assert_eq!(cut(&square), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(cut(&[DVec3::ONE; 4]), [[0, 1, 2], [0, 2, 3]], "without area");
    }
}
