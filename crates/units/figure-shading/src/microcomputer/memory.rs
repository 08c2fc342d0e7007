//! Memory (12): brightness of the last calculated flat polygon (Figure 7).

use super::Microcomputer;
use super::flatness::DISTANCE;
use super::normals::normals_of;
use super::plane::StoredPlane;
use super::state::CpuProcess;
use crate::cpu::CpuOperations;
use crate::local_memory::{PLANE, PLANE_NUMBERS, PolygonBuffer};
use basrelief_kernel::OperatorCounts;
use basrelief_signals::Polygon;
use glam::Vec3;

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
    pub(super) fn judge_plane(&mut self, polygon: &Polygon, normals: &[Vec3], buffer: PolygonBuffer) -> (bool, u64) {
        if !self.short_cuts.same_plane.enabled {
            return (false, 0);
        }
        let reused = self.state.plane.is_some_and(|p| p.holds(polygon, normals, &self.short_cuts.same_plane));
        self.state.counters.reused += u64::from(reused);
        let (points, read) = (normals.len() as u64, if reused { READ } else { CpuOperations::NONE });
        self.fetch(PLANE, STORED.load + read.load);
        self.fetch(buffer.points(), 3 * points);
        self.fetch(buffer.normals(), 3 * points);
        (reused, self.run(CpuProcess::SamePlane, STORED.and(COMPARISON.times(points)).and(read)))
    }

    /// Runs step 94. Returns its cycles.
    pub(super) fn store(&mut self, polygon: &Polygon, brightness: [f32; 3], buffer: PolygonBuffer) -> u64 {
        if !self.short_cuts.same_plane.enabled {
            return 0;
        }
        let normal = normals_of(polygon).first().copied().unwrap_or_default();
        self.state.plane = StoredPlane::of(polygon, normal, brightness);
        let points = polygon.vertices.len() as u64;
        self.fetch(buffer.points(), AREAS.load * points);
        self.store_numbers(PLANE, PLANE_NUMBERS);
        self.run(CpuProcess::SamePlane, AREAS.times(points).and(STORE))
    }
}
