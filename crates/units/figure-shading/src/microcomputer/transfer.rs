//! Process 23: transfers brightness to the brightness interpolation circuit (21).

use super::Microcomputer;
use super::state::Process;

impl Microcomputer {
    /// The cycles that it takes for these sample points.
    pub(super) fn transfer(&mut self, brightness: &[[f32; 3]]) -> u64 {
        self.run(Process::Transfer, u64::from(self.config.transfer_cycles_per_point) * brightness.len() as u64)
    }
}
