//! The test machine. It is built from a plan instead of a block diagram, so that tests can run random graphs.
//!
//! A plan is JSON. Plans and results have the formats of the project's executable reading of the laws of time. A token is (id,
//! last). [`UnitKind`] documents the tokens popped and emitted by each kind of unit.

mod check;
mod format;
mod machine;
mod result;
mod unit;

pub use check::PlanError;
pub use format::{
    Plan, PlanCache, PlanFifo, PlanFlips, PlanLookUp, PlanMemory, PlanPeriodic, PlanPort, PlanRequest, PlannedUnit, UnitKind,
};
pub use machine::PlanMachine;
pub use result::result;
pub use unit::Token;
