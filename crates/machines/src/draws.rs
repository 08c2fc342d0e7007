//! Interface of every machine.

use crate::engines::MachineEngines;
use basrelief_frame_buffer::FinishedFrame;
use basrelief_kernel::stats::UnitStats;

/// A machine that finishes pictures.
pub trait PictureMachine: MachineEngines {
    /// Returns the finished pictures in the frame buffer.
    fn finished(&mut self) -> &mut Vec<FinishedFrame>;
    /// Adds figures that depend on several units or on the configuration.
    fn derive(&self, facts: &mut UnitStats) {
        let _ = facts;
    }

    /// Removes and returns the pictures finished since the last call, in order. Should be called between batches of steps, so that memory
    /// does not grow with the number of frames.
    fn drain_finished(&mut self) -> Vec<FinishedFrame> {
        std::mem::take(self.finished())
    }

    /// Returns the statistics of the units in the order of the wiring, then the derived figures. Must be called after a run.
    fn facts(&mut self) -> UnitStats {
        let mut facts = self.unit_stats();
        self.derive(&mut facts);
        facts
    }
}
