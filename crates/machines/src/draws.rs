//! What every machine does, whichever it is.

use crate::Counts;
use basrelief_frame_buffer::FinishedFrame;
use basrelief_kernel::Machine;

/// A machine that finishes pictures.
pub trait Draws: Machine {
    /// What its units counted, in the order of the block diagram.
    fn counts(&self) -> Counts;
    /// Pictures finished since the last call, in order.
    fn drain_finished(&mut self) -> Vec<FinishedFrame>;
    /// Whether [`Draws::drain_finished`] would give any.
    fn has_finished(&self) -> bool;
}
