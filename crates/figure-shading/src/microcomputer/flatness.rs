//! Process 15: flatness decision, for the flatness register (16).

use basrelief_signals::Polygon;
use glam::Vec3;

/// Whether no normal is farther than `tolerance` from the first one. A polygon without points is not flat.
pub(crate) fn is_flat(normals: &[Vec3], tolerance: f32) -> bool {
    let Some(first) = normals.first() else { return false };
    are_near(normals, *first, tolerance)
}

/// Whether no normal is farther than `tolerance` from `normal`.
pub(super) fn are_near(normals: &[Vec3], normal: Vec3, tolerance: f32) -> bool {
    normals.iter().all(|n| n.distance_squared(normal) <= tolerance * tolerance)
}

/// Normals of the sample points; one that is not finite counts as zero.
pub(super) fn normals_of(polygon: &Polygon) -> Vec<Vec3> {
    polygon.vertices.iter().map(|v| crate::setting::normal_of(v.normal)).collect()
}
