//! Process 20: loads and starts the normal-interpolation brightness circuit (50).

use super::Microcomputer;
use super::normals::normals_of;
use super::state::{CpuProcess, DecidedPolygon};
use crate::cpu::CpuOperations;
use crate::local_memory::{LIGHT, LIGHTS};
use crate::{BrightnessSelection, NormalLoad, SpecularSkip};
use basrelief_signals::ShadingMode;
use std::sync::Arc;

/// The start command, and n.
const COMMAND: CpuOperations = CpuOperations { load: 1, store: 2, ..CpuOperations::NONE };
/// Per light: H and Is*Ks.
const OF_LIGHT: CpuOperations = CpuOperations { load: 4, multiply: 1, store: 4, ..CpuOperations::NONE };
/// Per sample point: position, depth and normal.
const POINT: CpuOperations = CpuOperations { load: 6, store: 6, ..CpuOperations::NONE };

impl Microcomputer {
    /// Returns the load of circuit (50) if it is started, and the cycles. It is started if its output is selected, or if
    /// `shade.specular_skip` starts it for a closed gate (51).
    pub(super) fn start(&mut self, decided: &DecidedPolygon) -> (Option<Arc<NormalLoad>>, u64) {
        let DecidedPolygon { polygon, registers, number, .. } = decided;
        let starts = match registers.selection() {
            BrightnessSelection::LinearAndSpecular => true,
            BrightnessSelection::Linear => {
                registers.mode == ShadingMode::Normal && self.shading.specular_skip == SpecularSkip::Gate
            }
            BrightnessSelection::Mean => false,
        };
        if !starts {
            return (None, 0);
        }
        self.state.counters.starts += 1;
        let (buffer, normals) = (self.buffer(*number), normals_of(polygon));
        let (points, lights) = (normals.len() as u64, self.state.illumination.lights.len() as u64);
        self.fetch(LIGHTS, LIGHT * lights);
        self.fetch(buffer.points(), 3 * points);
        self.fetch(buffer.normals(), 3 * points);
        let cycles = self.run(CpuProcess::Start, COMMAND.and(OF_LIGHT.times(lights)).and(POINT.times(points)));
        let (polygon, raster, illumination) = (Arc::clone(polygon), self.state.raster, Arc::clone(&self.state.illumination));
        (Some(Arc::new(NormalLoad { polygon, raster, normals, illumination, open: registers.specular })), cycles)
    }
}
