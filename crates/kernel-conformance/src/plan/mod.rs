//! The test machine: built from a plan rather than from a block diagram, so that random graphs can be run.
//!
//! A plan is JSON. Its format, and the format of the result, are those of the project's executable reading of the laws
//! of time; a token is (id, last). What each kind of unit takes and emits stands at [`Kind`].

mod check;
mod format;
mod machine;
mod result;
mod unit;

pub use check::PlanError;
pub use format::{Kind, Plan, PlanCache, PlanFifo, PlanLookUp, PlanMemory, PlanPort, PlanRequest, PlannedUnit};
pub use machine::PlanMachine;
pub use result::result;
pub use unit::Token;
