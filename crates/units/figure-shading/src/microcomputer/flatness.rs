//! Process 15: flatness decision, for the flatness register (16).

use super::Microcomputer;
use super::normals::{are_near, color_of};
use super::state::CpuProcess;
use crate::cpu::CpuOperations;
use crate::local_memory::PolygonBuffer;
use basrelief_kernel::OperatorCounts;
use basrelief_signals::{Polygon, ShadingMode};
use glam::Vec3;

/// Distance of a sample point's normal from another: three differences, their squares, a comparison.
pub(super) const DISTANCE: CpuOperations = CpuOperations {
    load: 3,
    compare: 1,
    ..CpuOperations::of(OperatorCounts::INNER_PRODUCT.and(OperatorCounts { add: 3, ..OperatorCounts::NONE }))
};

/// Returns true if no normal is farther than `tolerance` from the first one. A polygon without points is not flat.
fn is_flat(normals: &[Vec3], tolerance: f32) -> bool {
    let Some(first) = normals.first() else { return false };
    are_near(normals, *first, tolerance)
}

impl Microcomputer {
    /// Runs process 15, except in polyhedron mode, which needs no decision. A polygon whose points differ in colour is never
    /// flat. Ka and Kd include the colour here, so its brightness is not constant although its normal is.
    pub(super) fn judge_flatness(&mut self, polygon: &Polygon, normals: &[Vec3], buffer: PolygonBuffer) -> (bool, u64) {
        let matters = match self.state.settings.mode {
            ShadingMode::Normal => true,
            ShadingMode::Brightness => self.shading.flat_in_brightness_mode,
            ShadingMode::Polyhedron => false,
        };
        if !matters || !self.short_cuts.flatness.enabled {
            return (false, 0);
        }
        let flat = is_flat(normals, self.short_cuts.flatness.tolerance) && color_of(polygon).is_some();
        self.state.counters.flat += u64::from(flat);
        let points = normals.len() as u64;
        self.fetch(buffer.normals(), points * DISTANCE.load);
        (flat, self.run(CpuProcess::Flatness, DISTANCE.times(points)))
    }
}
