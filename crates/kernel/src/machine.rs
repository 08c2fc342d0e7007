//! Machines: a machine shows its block diagram to visitors, which run, account for and describe it.

use crate::{BoundStage, MemorySystem};

/// Who walks a machine's wiring: engines, accounting, reports.
pub trait Visitor {
    /// One stage in its place.
    fn stage<P: BoundStage>(&mut self, place: P);
}

/// A machine: its `wire` function is its block diagram, and the only place where the topology stands.
pub trait Machine {
    /// Shows every stage to `v`, always in the same order.
    fn wire<V: Visitor>(&mut self, v: &mut V);
    /// The memories that its stages share.
    fn memories(&mut self) -> &mut MemorySystem;
    /// Whether it has finished something that somebody waits for: [`Limits::progress`](crate::Limits::progress) is then called as soon
    /// as its stages have been walked over, and not only every now and then. A stage may wait for the outside in its next step.
    fn has_news(&self) -> bool {
        false
    }
}
