//! Quantized bump-mapping processor (Sony; inventor A. Ohba).
//!
//! Figure 1, as wired by [`BumpProcessor`]:
//!
//! ```text
#![doc = include_str!("diagram.txt")]
//! ```

mod check;
mod config;
mod machine;
mod memories;
mod spec;

pub use crate::config::{ClockConfig, ReferenceConfig, ReferenceFilter};
pub use crate::front::FrontEnd;
pub use crate::problem::ConfigProblem;
pub use check::warnings;
pub use config::{BumpProcessorConfig, CacheConfigs, FifoConfigs, MemoryConfigs};
pub use machine::BumpProcessor;

/// Name of the machine.
pub const NAME: &str = "bump";

/// Figure 1 as text.
pub const DIAGRAM: &str = include_str!("diagram.txt");
