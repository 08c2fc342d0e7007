//! Process 24: mean brightness of a polygon, and its output.

use super::Microcomputer;
use super::outputs::{Out, nothing};
use super::state::{CpuPhase, CpuProcess, DecidedPolygon};
use crate::cpu::CpuOperations;
use crate::dots::{DEPTH_SET_UP, SCAN_SET_UP};
use crate::{FigureFlow, ShadedDot};
use basrelief_kernel::Step;
use basrelief_shading::fan_triangles;
use basrelief_signals::{Fragment, ShadingMode};

/// Per sample point: sum of its components.
const SUM: CpuOperations = CpuOperations { load: 3, add: 3, ..CpuOperations::NONE };
/// The reciprocal of the number of points, and three products.
const SHARE: CpuOperations = CpuOperations { divide: 1, multiply: 3, ..CpuOperations::NONE };
/// The brightness is written to the selectors' input once for all dots of a polygon.
const BRIGHTNESS: CpuOperations = CpuOperations { store: 3, ..CpuOperations::NONE };
/// Set-up of a triangle of the fan, from nine coordinates.
const SET_UP: CpuOperations = CpuOperations { load: 9, compare: 4, ..CpuOperations::of(SCAN_SET_UP.and(DEPTH_SET_UP)) };
/// Returns the mean over the sample points, or black if there are none.
pub(crate) fn mean(brightness: &[[f32; 3]]) -> [f32; 3] {
    let Some((first, others)) = brightness.split_first() else { return [0.0; 3] };
    // Starting from the first and adding differences makes the mean of equal values exact.
    let share = 1.0 / brightness.len() as f32;
    std::array::from_fn(|i| first[i] + others.iter().map(|b| b[i] - first[i]).sum::<f32>() * share)
}

impl Microcomputer {
    /// Returns the brightness of all dots, reused or calculated from the sample points, and its cycles.
    pub(super) fn mean(&mut self, decided: &DecidedPolygon, brightness: &[[f32; 3]]) -> ([f32; 3], u64) {
        if let (true, Some(plane)) = (decided.reused, &self.state.plane) {
            return (plane.brightness, 0);
        }
        let (buffer, points) = (self.buffer(decided.number), brightness.len() as u64);
        self.fetch(buffer.brightness(), SUM.load * points);
        let mut cycles = self.run(CpuProcess::Mean, SUM.times(points).and(SHARE));
        let mean = mean(brightness);
        if self.state.settings.mode != ShadingMode::Polyhedron {
            cycles += self.store(&decided.polygon, mean, buffer);
        }
        (mean, cycles)
    }

    /// Sets up the output. Returns its cycles.
    pub(super) fn set_up_output(&mut self, decided: &DecidedPolygon) -> u64 {
        let (points, triangles) = (decided.polygon.vertices.len() as u64, u64::from(fan_triangles(&decided.polygon)));
        self.fetch(self.buffer(decided.number).points(), 3 * points);
        self.spend(CpuProcess::Mean, BRIGHTNESS.and(SET_UP.times(triangles)))
    }

    /// Returns the next dot of process 24, or the polygon's end.
    #[inline]
    pub(super) fn put_out(&mut self) -> Out {
        let CpuPhase::Output { figure, brightness } = &self.state.phase else { return nothing(1) };
        let to_53 = figure.registers.mean_goes_to_53();
        let mut cycles = 1;
        let signal = if let Some(Fragment { x, y, z, .. }) = self.state.dots.next(&figure.polygon) {
            cycles = self.dot_cycles;
            self.state.counters.dots += 1;
            self.state.counters.processes[CpuProcess::Mean as usize].cycles += cycles;
            FigureFlow::Dot(ShadedDot { x, y, z, brightness: *brightness })
        } else {
            self.state.phase = CpuPhase::Idle;
            FigureFlow::End
        };
        let out = if to_53 { (None, None, Some(signal), None) } else { (None, None, None, Some(signal)) };
        Step::after(cycles, out).busy(cycles)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Claim: as section_2_constant_shading_is_mean_of_sample_points.
    #[test]
    fn mean_of_equal_brightness_is_exact() {
        for b in [0.1, 0.3, 0.7, 1.0 / 3.0] {
            assert_eq!(mean(&[[b; 3]; 7]), [b; 3]);
        }
        assert_eq!(mean(&[[0.0; 3], [0.5; 3], [1.0; 3]]), [0.5; 3]);
        assert_eq!(mean(&[]), [0.0; 3]);
    }
}
