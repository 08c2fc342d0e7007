//! The rate-limited renderer (HP, 1998; JP 2000-057370).
//!
//! Figure 1, as it is wired by [`DeferredRenderer`]:
//!
//! ```text
#![doc = include_str!("diagram.txt")]
//! ```

mod check;
mod config;
mod fifos;
mod machine;
mod memories;
mod units;

pub use crate::config::ClockConfig;
pub use crate::front::{FrontEnd, SceneFront, TraceFront};
pub use crate::problem::ConfigProblem;
pub use crate::unit_info::UnitInfo;
pub use check::warnings;
pub use config::{CacheConfigs, DeferConfig, MemoryConfigs};
pub use fifos::FifoConfigs;
pub use machine::DeferredRenderer;
pub use units::UNITS;

/// Name of the machine.
pub const NAME: &str = "defer";

/// Figure 1 in characters.
pub const DIAGRAM: &str = include_str!("diagram.txt");
