//! Process 23: transfers brightness to the brightness interpolation circuit (21).

use super::Microcomputer;
use super::state::CpuProcess;
use crate::cpu::CpuOperations;
use crate::local_memory::PolygonBuffer;

/// Per sample point: position, depth and three components.
const POINT: CpuOperations = CpuOperations { load: 6, store: 6, ..CpuOperations::NONE };

impl Microcomputer {
    /// Returns the cycles for these sample points.
    pub(super) fn transfer(&mut self, brightness: &[[f32; 3]], buffer: PolygonBuffer) -> u64 {
        let points = brightness.len() as u64;
        self.fetch(buffer.points(), 3 * points);
        self.fetch(buffer.brightness(), 3 * points);
        self.run(CpuProcess::Transfer, POINT.times(points))
    }
}
