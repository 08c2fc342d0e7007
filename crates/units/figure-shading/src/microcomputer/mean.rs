//! Process 24: mean brightness of a polygon, and its output.

use super::Microcomputer;
use super::state::{Phase, Process};
use super::unit::{Out, nothing};
use crate::{Dot, Mode, Signal};
use basrelief_kernel::Step;
use basrelief_signals::{Fragment, Polygon};

/// Mean over the sample points; black without any.
pub(crate) fn mean(brightness: &[[f32; 3]]) -> [f32; 3] {
    let Some((first, others)) = brightness.split_first() else { return [0.0; 3] };
    // The first, and what the others differ by: of equal ones the mean is exactly that.
    let share = 1.0 / brightness.len() as f32;
    std::array::from_fn(|i| first[i] + others.iter().map(|b| b[i] - first[i]).sum::<f32>() * share)
}

impl Microcomputer {
    /// Brightness of all dots, reused or calculated from that of the sample points, and the cycles that it takes.
    pub(super) fn mean(&mut self, polygon: &Polygon, brightness: &[[f32; 3]], reused: bool) -> ([f32; 3], u64) {
        if let (true, Some(plane)) = (reused, &self.state.plane) {
            return (plane.brightness, 0);
        }
        let mut cycles = self.run(Process::Mean, u64::from(self.config.mean_cycles_per_point) * brightness.len() as u64);
        let mean = mean(brightness);
        if self.shading.mode != Mode::Polyhedron {
            cycles += self.store(polygon, mean);
        }
        (mean, cycles)
    }

    /// The next dot of process 24, or the polygon's end.
    #[inline]
    pub(super) fn put_out(&mut self) -> Out {
        let Phase::Output { figure, brightness } = &self.state.phase else { return nothing(1) };
        let to_53 = figure.registers.mean_goes_to_53();
        let mut cycles = 1;
        let signal = if let Some(Fragment { x, y, z, .. }) = self.state.dots.next(&figure.polygon) {
            cycles = u64::from(self.config.dot_cycles);
            self.state.counters.dots += 1;
            self.state.counters.processes[Process::Mean as usize].cycles += cycles;
            Signal::Dot(Dot { x, y, z, brightness: *brightness })
        } else {
            self.state.phase = Phase::Idle;
            Signal::End
        };
        let out = if to_53 { (None, None, Some(signal), None) } else { (None, None, None, Some(signal)) };
        Step::after(cycles, out).busy(cycles)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_equal_brightness_is_that_brightness() {
        for b in [0.1, 0.3, 0.7, 1.0 / 3.0] {
            assert_eq!(mean(&[[b; 3]; 7]), [b; 3]);
        }
        assert_eq!(mean(&[[0.0; 3], [0.5; 3], [1.0; 3]]), [0.5; 3]);
        assert_eq!(mean(&[]), [0.0; 3]);
    }
}
