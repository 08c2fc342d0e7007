//! Machines: a machine shows its block diagram to visitors, which run, account for and describe it.

use crate::{BoundStage, MemorySystem};

/// A visitor of a machine's wiring: an engine, the accounting, or a report.
pub trait Visitor {
    /// Visits one stage with its connections.
    fn stage<P: BoundStage>(&mut self, place: P);
}

/// A machine. Its `wire` function is its block diagram and the only definition of its topology.
pub trait Machine {
    /// Shows every stage to `v`, always in the same order.
    fn wire<V: Visitor>(&mut self, v: &mut V);
    /// The memories that its stages share.
    fn memories(&mut self) -> &mut MemorySystem;
    /// Returns true if the machine has a finished result that the caller waits for. [`RunLimits::progress`](crate::RunLimits::progress)
    /// is then called after the current round instead of once in several rounds. A stage may wait for the caller in its next
    /// step.
    fn has_news(&self) -> bool {
        false
    }
}
