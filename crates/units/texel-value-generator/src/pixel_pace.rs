//! Operators in which the operations of a pixel take turns.

use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{OperatorCounts, Operators};

/// Operators of the machine, and the cycles between two pixels.
pub(crate) struct PixelPace<'a> {
    pub(crate) operators: &'a Operators,
    pub(crate) interval: u32,
}

impl PixelPace<'_> {
    /// Reports the fewest operators of `width` bits for the work of each pixel.
    pub(crate) fn tell(&self, about: &'static str, work: OperatorCounts, width: u32, stats: &mut UnitStats) {
        stats.shared_operators(about, self.operators.sustaining(work, self.interval), work, width);
    }
}
