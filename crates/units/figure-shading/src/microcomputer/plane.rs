//! Plane and brightness of the last calculated flat polygon (Figure 7).

use super::normals::{are_near, color_of};
use crate::SamePlaneConfig;
use basrelief_shading::doubled_area;
use basrelief_signals::Polygon;
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// Data of the last calculated flat polygon in memory (12).
///
/// The plane is stored in window coordinates, like the points, because a projection preserves planes. Instead of its constant,
/// the depth of each new point is compared with the plane: the slopes of an almost edge-on polygon would make any constant
/// worthless. The colour of the points is part of the key, because Ka and Kd include it here.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StoredPlane {
    normal: Vec3,
    color: [f32; 3],
    /// A point of the plane: x, y \[pixels\], depth.
    anchor: [f32; 3],
    /// Change of depth per pixel in x and y.
    slope: [f32; 2],
    /// Brightness of the polygon.
    pub(super) brightness: [f32; 3],
}

impl StoredPlane {
    /// Returns the data of a flat polygon with this brightness. Returns `None` if its points differ in colour, or lie on a line.
    pub(super) fn of(polygon: &Polygon, normal: Vec3, brightness: [f32; 3]) -> Option<Self> {
        let color = color_of(polygon)?;
        let area = |x: usize, y: usize| doubled_area(polygon.vertices.iter().map(|v| [v.position[x], v.position[y]]));
        let window = area(0, 1);
        let slope = [area(2, 1) / window, area(0, 2) / window];
        let [x, y, z, _] = polygon.vertices.first()?.position;
        slope.iter().all(|s| s.is_finite()).then_some(Self { normal, color, anchor: [x, y, z], slope, brightness })
    }

    /// Step 92: returns true if a flat polygon with these normals lies on this plane, in the same colour.
    pub(super) fn holds(&self, polygon: &Polygon, normals: &[Vec3], config: &SamePlaneConfig) -> bool {
        let [x, y, z] = self.anchor;
        let is_on = |p: &[f32; 4]| {
            let depth = z + self.slope[0] * (p[0] - x) + self.slope[1] * (p[1] - y);
            (p[2] - depth).abs() <= config.constant_tolerance
        };
        are_near(normals, self.normal, config.normal_tolerance)
            && color_of(polygon) == Some(self.color)
            && polygon.vertices.iter().all(|v| is_on(&v.position))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_signals::Vertex;
    use proptest::prelude::*;
    use std::sync::Arc;

    fn polygon(points: &[[f32; 3]]) -> Polygon {
        let vertex = |&[x, y, z]: &[f32; 3]| Vertex { position: [x, y, z, 1.0], ..Vertex::default() };
        let vertices = points.iter().map(vertex).collect();
        Polygon { vertices, material: Arc::default(), object: 0, lod: 0, bump: false, arrival: 0 }
    }

    // Claim: as figure_7_any_new_input_voids_stored_brightness.
    #[test]
    fn polygon_without_area_or_of_several_colours_is_not_stored() {
        let line = polygon(&[[1.0, 1.0, 0.1], [2.0, 2.0, 0.2], [3.0, 3.0, 0.9]]);
        assert_eq!(StoredPlane::of(&line, Vec3::Z, [0.5; 3]), None);
        let mut coloured = polygon(&[[1.0, 1.0, 0.1], [2.0, 1.0, 0.1], [1.0, 2.0, 0.1]]);
        assert!(StoredPlane::of(&coloured, Vec3::Z, [0.5; 3]).is_some());
        coloured.vertices[1].color = [1.0, 0.0, 0.0, 1.0];
        assert_eq!(StoredPlane::of(&coloured, Vec3::Z, [0.5; 3]), None);
    }

    proptest! {
        // Claim: as same_plane_changes_output_within_tolerance.
        #[test]
        fn figure_7_step_92_tests_normal_and_plane(
            slope in prop::array::uniform2(-1e-3f32..1e-3), at in prop::array::uniform4(5f32..100.0), off in prop_oneof![0f32..0.8e-4, 1.0 / 8192.0..3e-4f32], below in any::<bool>(),
        ) {
            let z = |x: f32, y: f32| 0.5 + slope[0] * x + slope[1] * y;
            let square = |x: f32, y: f32, off: f32| {
                polygon(&[[x, y], [x + 9.0, y], [x + 9.0, y + 7.0]].map(|[x, y]| [x, y, z(x, y) + off]))
            };
            let plane = StoredPlane::of(&square(at[0], at[1], 0.0), Vec3::Z, [0.5; 3]).expect("has an area");
            let other = square(at[2], at[3], if below { -off } else { off });
            let config = SamePlaneConfig::default();
            prop_assert_eq!(plane.holds(&other, &[Vec3::Z; 3], &config), off < config.constant_tolerance);
            prop_assert!(!plane.holds(&square(at[2], at[3], 0.0), &[Vec3::Z, Vec3::Z, Vec3::new(0.0, 1e-3, 1.0)], &config));
        }
    }
}
