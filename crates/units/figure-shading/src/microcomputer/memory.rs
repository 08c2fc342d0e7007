//! Memory (12): brightness of the last calculated flat polygon (Figure 7).

use super::Microcomputer;
use super::flatness::{DISTANCE, are_near, color_of, normals_of};
use super::state::CpuProcess;
use crate::SamePlaneConfig;
use crate::cpu::CpuOperations;
use crate::local_memory::{PLANE, PLANE_NUMBERS, PolygonBuffer};
use basrelief_kernel::{MemoryPorts, OperatorCounts};
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

/// Step 92, per sample point: comparison of its normal with the stored one, and of its depth with that of the stored plane.
const COMPARISON: CpuOperations = DISTANCE.and(CpuOperations {
    load: 3,
    compare: 1,
    ..CpuOperations::of(OperatorCounts { multiply: 2, add: 5, ..OperatorCounts::NONE })
});
/// Step 92: loads of the stored data without brightness, and comparison of the colours.
const STORED: CpuOperations = CpuOperations { load: 11, compare: 3, ..CpuOperations::NONE };
/// Step 95: load of the stored brightness.
const READ: CpuOperations = CpuOperations { load: 3, ..CpuOperations::NONE };
/// Step 94, per sample point: its share in three areas, one along each axis, of two products and two sums each.
const AREAS: CpuOperations =
    CpuOperations { load: 3, ..CpuOperations::of(OperatorCounts { multiply: 6, add: 6, ..OperatorCounts::NONE }) };
/// Step 94: two slopes.
const STORE: CpuOperations = CpuOperations { divide: 2, store: PLANE_NUMBERS, ..CpuOperations::NONE };

impl Microcomputer {
    /// Runs step 92 of Figure 7, and step 95 if the brightness is reused.
    pub(super) fn judge_plane(
        &mut self,
        polygon: &Polygon,
        normals: &[Vec3],
        buffer: PolygonBuffer,
        traffic: &mut MemoryPorts,
    ) -> (bool, u64) {
        if !self.short_cuts.same_plane.enabled {
            return (false, 0);
        }
        let reused = self.state.plane.is_some_and(|p| p.holds(polygon, normals, &self.short_cuts.same_plane));
        self.state.counters.reused += u64::from(reused);
        let (points, read) = (normals.len() as u64, if reused { READ } else { CpuOperations::NONE });
        self.port.read(traffic, PLANE, STORED.load + read.load);
        self.port.read(traffic, buffer.points(), 3 * points);
        self.port.read(traffic, buffer.normals(), 3 * points);
        (reused, self.run(CpuProcess::SamePlane, STORED.and(COMPARISON.times(points)).and(read)))
    }

    /// Runs step 94. Returns its cycles.
    pub(super) fn store(
        &mut self,
        polygon: &Polygon,
        brightness: [f32; 3],
        buffer: PolygonBuffer,
        traffic: &mut MemoryPorts,
    ) -> u64 {
        if !self.short_cuts.same_plane.enabled {
            return 0;
        }
        let normal = normals_of(polygon).first().copied().unwrap_or_default();
        self.state.plane = StoredPlane::of(polygon, normal, brightness);
        let points = polygon.vertices.len() as u64;
        self.port.read(traffic, buffer.points(), AREAS.load * points);
        self.port.write(traffic, PLANE, PLANE_NUMBERS);
        self.run(CpuProcess::SamePlane, AREAS.times(points).and(STORE))
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
