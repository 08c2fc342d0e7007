//! Clipping against the view volume.
//!
//! Near and far are exact. At the sides, a polygon is cut only if it leaves the guard band. The rasterizer ignores pixels off the
//! screen, and an uncut edge stays exactly the edge of its neighbour.

use crate::transform::ClipCorner;
use basrelief_kernel::OperatorCounts;
use basrelief_signals::MapInline as _;
use basrelief_signals::Vertex;
use glam::{Vec3, Vec4};

/// Half width and height of the guard band in half widths and heights of the screen (assumed). 4.5 screens to each side of the
/// centre of the widest picture are 74,000 pixels, well inside the rasterizer's range.
const GUARD: f32 = 8.0;

/// Result of clipping a triangle.
#[derive(Clone, Debug, PartialEq)]
pub enum ClipResult {
    /// All corners are outside the same side of the view volume.
    Outside,
    /// The triangle is unchanged.
    Whole,
    /// The triangle was cut to a polygon.
    Cut {
        /// Corners in order, 3..=9 unless the polygon degenerates.
        corners: Vec<ClipCorner>,
        /// Corners computed, including those that a later plane removed.
        made: u32,
    },
}

/// Arithmetic of the distances of a corner to six planes, and to four more of the guard band. The product reach * w is a shift.
pub const DISTANCES: OperatorCounts = OperatorCounts { add: 10, ..OperatorCounts::NONE };

/// Returns the arithmetic of a corner at a cut edge: its share of the edge, clip coordinates, `numbers` further numbers,
/// `directions` vectors of three made unit again, and its distances.
pub fn made_corner(numbers: u32, directions: u32) -> OperatorCounts {
    let share = OperatorCounts { divide: 1, add: 1, ..OperatorCounts::NONE };
    let mixed = OperatorCounts { multiply: 1, add: 2, ..OperatorCounts::NONE }.times(4 + numbers);
    share.and(mixed).and(OperatorCounts::NORMALIZE.times(directions)).and(DISTANCES)
}

/// Returns the signed distances to the six planes, >= 0 inside. The side planes lie `reach` times as far out as those of the
/// screen.
fn distances(clip: Vec4, reach: f32) -> [f32; 6] {
    let Vec4 { x, y, z, w } = clip;
    let side = reach * w;
    [z + w, w - z, side + x, side - x, side + y, side - y]
}

/// Clips a triangle with finite coordinates.
pub fn clip(triangle: &[ClipCorner; 3]) -> ClipResult {
    let [a, b, c] = [0, 1, 2].map_inline(|i| outside(triangle[i].clip, 1.0));
    if a & b & c != 0 {
        return ClipResult::Outside;
    }
    // A corner inside the view volume is inside the guard band, so in most cases no other test is needed.
    if a | b | c == 0 || triangle.iter().all(|c| outside(c.clip, GUARD) == 0) {
        return ClipResult::Whole;
    }
    let (mut corners, mut made) = (triangle.to_vec(), 0);
    for plane in 0..6 {
        let distance = |c: &ClipCorner| distances(c.clip, GUARD)[plane];
        let inside = corners.iter().filter(|c| distance(c) >= 0.0).count();
        if inside < corners.len() {
            corners = cut_at(&corners, distance);
            made += (corners.len() - inside) as u32;
        }
    }
    ClipResult::Cut { corners, made }
}

/// Returns the planes that the point is outside of, one bit each.
#[inline]
fn outside(clip: Vec4, reach: f32) -> u32 {
    distances(clip, reach).iter().rev().fold(0, |planes, &d| planes << 1 | u32::from(d < 0.0))
}

/// Returns the part on the inner side (Sutherland and Hodgman). A new corner is always computed from the inner to the outer end
/// of its edge. Triangles that share the edge therefore get the same corner.
fn cut_at(corners: &[ClipCorner], distance: impl Fn(&ClipCorner) -> f32) -> Vec<ClipCorner> {
    let mut kept = Vec::with_capacity(corners.len() + 1);
    let successors = corners.iter().cycle().skip(1);
    for (here, next) in corners.iter().zip(successors) {
        let (d, e) = (distance(here), distance(next));
        if d >= 0.0 {
            kept.push(*here);
        }
        match (d >= 0.0, e >= 0.0) {
            (true, false) => kept.push(between(here, next, d / (d - e))),
            (false, true) => kept.push(between(next, here, e / (e - d))),
            _ => {}
        }
    }
    kept
}

/// Returns the corner at share `t` of the way from `a` to `b`.
fn between(a: &ClipCorner, b: &ClipCorner, t: f32) -> ClipCorner {
    fn mix<const N: usize>(a: [f32; N], b: [f32; N], t: f32) -> [f32; N] {
        std::array::from_fn(|i| a[i] + t * (b[i] - a[i]))
    }
    let (p, q) = (&a.vertex, &b.vertex);
    let normal = Vec3::from(mix(p.normal, q.normal, t)).normalize_or(Vec3::from(p.normal));
    let tangent = Vec4::from(mix(p.tangent, q.tangent, t)).truncate().normalize_or_zero();
    ClipCorner {
        clip: a.clip + t * (b.clip - a.clip),
        vertex: Vertex {
            normal: normal.to_array(),
            tangent: tangent.extend(p.tangent[3]).to_array(),
            uv: mix(p.uv, q.uv, t),
            uv_normal: mix(p.uv_normal, q.uv_normal, t),
            color: mix(p.color, q.color, t),
            ..Vertex::default()
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn corner(x: f32, y: f32, z: f32, w: f32) -> ClipCorner {
        ClipCorner { clip: Vec4::new(x, y, z, w), vertex: Vertex { uv: [x, y], ..Vertex::default() } }
    }

    fn any_corner() -> impl Strategy<Value = ClipCorner> {
        (-20f32..20.0, -20f32..20.0, -3f32..3.0, -2f32..2.0).prop_map(|(x, y, z, w)| corner(x, y, z, w))
    }

    #[test]
    fn inside_triangle_is_kept_outside_triangle_is_dropped() {
        let inside = [corner(-1.0, 0.0, 0.0, 1.0), corner(1.0, -1.0, -1.0, 1.0), corner(4.0, 1.0, 1.0, 1.0)];
        assert_eq!(clip(&inside), ClipResult::Whole);
        assert_eq!(clip(&inside.map(|c| corner(c.clip.x, 1.5, 0.0, 1.0))), ClipResult::Outside);
        assert_eq!(clip(&inside.map(|c| corner(c.clip.x, 0.0, 0.0, -1.0))), ClipResult::Outside);
    }

    #[test]
    fn near_plane_cuts_one_corner_into_two() {
        let t = [corner(0.0, 0.0, -3.0, 1.0), corner(1.0, 0.0, 1.0, 1.0), corner(0.0, 1.0, 1.0, 1.0)];
        let ClipResult::Cut { corners, made } = clip(&t) else { panic!("something is cut") };
        assert_eq!((corners.len(), made), (4, 2));
        assert_eq!(corners[0].clip, Vec4::new(0.5, 0.0, -1.0, 1.0));
        assert_eq!(corners[0].vertex.uv, [0.5, 0.0]);
    }

    proptest! {
        #[test]
        fn clipped_polygon_is_inside_with_at_most_nine_corners(t in [any_corner(), any_corner(), any_corner()]) {
            let clipped = clip(&t);
            let corners = match &clipped {
                ClipResult::Outside => &[][..],
                ClipResult::Whole => &t,
                ClipResult::Cut { corners, .. } => corners,
            };
            prop_assert!(corners.len() <= 9);
            for c in corners {
                let scale = c.clip.abs().max_element();
                prop_assert!(distances(c.clip, GUARD).iter().all(|d| *d >= -1e-4 * scale.max(1.0)), "{c:?}");
            }
        }

        #[test]
        fn shared_edge_is_cut_at_same_corner(a in any_corner(), b in any_corner(), c in any_corner(), d in any_corner()) {
            let near = |c: &ClipCorner| distances(c.clip, GUARD)[0];
            prop_assume!((near(&a) < 0.0) != (near(&b) < 0.0));
            let new = |corners: Vec<ClipCorner>, old: [ClipCorner; 3]| -> Vec<ClipCorner> {
                corners.into_iter().filter(|p| !old.contains(p)).collect()
            };
            let (left, right) = (new(cut_at(&[a, b, c], near), [a, b, c]), new(cut_at(&[b, a, d], near), [b, a, d]));
            prop_assert!(left.iter().any(|p| right.contains(p)), "{left:?} {right:?}");
        }
    }
}
