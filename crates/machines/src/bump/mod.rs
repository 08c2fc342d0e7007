//! The quantized bump-mapping processor (Sony; inventor A. Ohba).
//!
//! Figure 1, as it is wired by [`BumpProcessor`]:
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

pub use crate::config::{ClockConfig, ReferenceConfig, ReferenceFilter};
pub use crate::front::{FrontEnd, SceneFront, TraceFront};
pub use crate::problem::ConfigProblem;
pub use crate::unit_info::UnitInfo;
pub use check::warnings;
pub use config::{BumpProcessorConfig, CacheConfigs, MemoryConfigs};
pub use fifos::FifoConfigs;
pub use machine::BumpProcessor;
pub use units::UNITS;

/// Figure 1 in characters.
pub const DIAGRAM: &str = include_str!("diagram.txt");
