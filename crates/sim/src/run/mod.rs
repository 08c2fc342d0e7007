//! Runs of a machine.

#[cfg(feature = "unwatched")]
pub(crate) mod bare;
pub(crate) mod compared_frame;
pub(crate) mod concurrent;
pub(crate) mod display_list;
mod exact;
pub(crate) mod memory_estimates;
pub(crate) mod result;
mod session;
mod single;
mod trace_tap;
pub(crate) mod untimed;
mod view_schedule_solver;

pub use single::{run, timeline_layout};
