//! Process 20: loads and starts the normal-interpolation brightness circuit (50).

use super::Microcomputer;
use super::state::Process;
use crate::{Mode, NormalLoad, Registers, Selection, SpecularSkip};
use basrelief_signals::Polygon;
use glam::Vec3;
use std::sync::Arc;

impl Microcomputer {
    /// What circuit (50) is loaded with, if it is started, and the cycles that it takes. It is started where its output is
    /// selected; where gate (51) will hold that back, too, if `shade.specular_skip` says so.
    pub(super) fn start(
        &mut self,
        polygon: &Arc<Polygon>,
        normals: Vec<Vec3>,
        registers: Registers,
    ) -> (Option<Arc<NormalLoad>>, u64) {
        let starts = match registers.selection() {
            Selection::LinearAndSpecular => true,
            Selection::Linear => registers.mode == Mode::Normal && self.shading.specular_skip == SpecularSkip::Gate,
            Selection::Mean => false,
        };
        if !starts {
            return (None, 0);
        }
        self.state.counters.starts += 1;
        let load_cycles = u64::from(self.config.load_cycles_per_point) * normals.len() as u64;
        let cycles = self.run(Process::Start, u64::from(self.config.start_cycles) + load_cycles);
        let (polygon, raster, illumination) = (Arc::clone(polygon), self.state.raster, Arc::clone(&self.state.illumination));
        (Some(Arc::new(NormalLoad { polygon, raster, normals, illumination, open: registers.specular })), cycles)
    }
}
