//! Normals for meshes that have none.

use glam::DVec3;

/// Unit normals per vertex: the mean of the face normals around it, weighted with the angles of the faces' corners, so
/// that the way a surface is cut into triangles does not show. A vertex without area around it gets (0, 0, 1).
pub(crate) fn smooth(positions: &[[f32; 3]], indices: &[u32]) -> Vec<[f32; 3]> {
    let mut sums = vec![DVec3::ZERO; positions.len()];
    for corners in indices.chunks_exact(3) {
        let points = [0, 1, 2].map(|i| point(positions, corners[i]));
        let normal = face(points);
        for i in 0..3 {
            let to = |j: usize| (points[j] - points[i]).normalize_or_zero();
            let angle = libm::acos(to((i + 1) % 3).dot(to((i + 2) % 3)).clamp(-1.0, 1.0));
            if let Some(sum) = sums.get_mut(corners[i] as usize) {
                *sum += normal * angle;
            }
        }
    }
    sums.into_iter().map(|n| unit(n, DVec3::Z)).collect()
}

/// The unit normal of each triangle; (0, 0, 1) where it has no area.
pub(crate) fn flat(positions: &[[f32; 3]], indices: &[u32]) -> Vec<[f32; 3]> {
    indices.chunks_exact(3).map(|c| unit(face([0, 1, 2].map(|i| point(positions, c[i]))), DVec3::Z)).collect()
}

/// A unit vector in single precision, or the fallback where the vector has no direction.
pub(crate) fn unit(v: DVec3, fallback: DVec3) -> [f32; 3] {
    v.normalize_or(fallback).as_vec3().to_array()
}

/// A vertex in double precision, in which products of the largest single-precision numbers do not overflow.
fn point(positions: &[[f32; 3]], index: u32) -> DVec3 {
    positions.get(index as usize).map_or(DVec3::ZERO, |p| DVec3::from_array(p.map(f64::from)))
}

fn face([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A corner of a cube, one of its faces cut in two at that corner: all three faces count alike.
    #[test]
    fn triangulation_does_not_affect_normals() {
        let positions = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.], [0., 0., 1.], [0., 1., 1.], [1., 0., 1.]];
        let indices = [0, 2, 1, 0, 3, 2, 0, 4, 3, 3, 4, 5, 0, 1, 4, 1, 6, 4];
        let third = -1.0 / 3.0f32.sqrt();
        for c in smooth(&positions, &indices)[0] {
            assert!((c - third).abs() < 1e-6, "{c}");
        }
    }

    #[test]
    fn zero_area_face_has_a_normal() {
        let positions = [[1.0; 3]; 3];
        assert_eq!(smooth(&positions, &[0, 1, 2]), [[0.0, 0.0, 1.0]; 3]);
        assert_eq!(flat(&positions, &[0, 1, 2]), [[0.0, 0.0, 1.0]]);
    }

    #[test]
    fn counter_clockwise_is_the_front() {
        let positions = [[0., 0., 0.], [1e20, 0., 0.], [0., 1e20, 0.]];
        assert_eq!(flat(&positions, &[0, 1, 2]), [[0.0, 0.0, 1.0]]);
    }
}
