//! What every machine does, whichever it is.

use basrelief_frame_buffer::FinishedFrame;
use basrelief_kernel::Machine;
use basrelief_kernel::stats::{UnitStats, unit_stats};

/// A machine that finishes pictures.
pub trait Draws: Machine {
    /// Where its frame buffer puts the pictures that it has finished.
    fn finished(&mut self) -> &mut Vec<FinishedFrame>;
    /// Tells figures that follow from those of several units, or from the configuration: no unit knows them alone.
    fn derive(&self, facts: &mut UnitStats) {
        let _ = facts;
    }

    /// Pictures finished since the last call, in order; to be called between batches of steps, so that memory does not grow
    /// with the number of frames.
    fn drain_finished(&mut self) -> Vec<FinishedFrame> {
        std::mem::take(self.finished())
    }

    /// What its units tell, in the order of the wiring, then what follows from it. To be called after a run.
    fn facts(&mut self) -> UnitStats
    where
        Self: Sized,
    {
        let mut facts = unit_stats(self);
        self.derive(&mut facts);
        facts
    }
}
