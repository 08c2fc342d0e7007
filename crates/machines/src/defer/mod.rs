//! Rate-limited renderer (HP, 1998; JP 2000-057370).
//!
//! Figure 1, as wired by [`DeferredRenderer`]:
//!
//! ```text
#![doc = include_str!("diagram.txt")]
//! ```

mod check;
mod config;
mod leaving;
mod machine;
mod memories;
mod spec;

pub use crate::config::ClockConfig;
pub use crate::front::FrontEnd;
pub use crate::problem::ConfigProblem;
pub use check::warnings;
pub use config::{CacheConfigs, DeferConfig, FifoConfigs, MemoryConfigs};
pub use leaving::RunAhead;
pub use machine::DeferredRenderer;
pub use spec::DeferLog;

/// Name of the machine.
pub const NAME: &str = "defer";

/// Figure 1 as text.
pub const DIAGRAM: &str = include_str!("diagram.txt");
