//! Normals and colours of the sample points of a polygon.

use basrelief_signals::Polygon;
use glam::Vec3;

/// Returns true if no normal is farther than `tolerance` from `normal`.
pub(super) fn are_near(normals: &[Vec3], normal: Vec3, tolerance: f32) -> bool {
    normals.iter().all(|n| n.distance_squared(normal) <= tolerance * tolerance)
}

/// Returns the normals of the sample points. A normal that is not finite counts as zero.
pub(super) fn normals_of(polygon: &Polygon) -> Vec<Vec3> {
    polygon.vertices.iter().map(|v| crate::illumination::normal_of(v.normal)).collect()
}

/// Returns the colour of all sample points if they have the same one.
pub(super) fn color_of(polygon: &Polygon) -> Option<[f32; 3]> {
    let mut colors = polygon.vertices.iter().map(|v| [v.color[0], v.color[1], v.color[2]]);
    let first = colors.next()?;
    colors.all(|c| c == first).then_some(first)
}
