//! The quantized bump-mapping processor (Sony; inventor A. Ohba).
//!
//! Figure 1, as it is wired by [`BumpProcessor`]:
//!
//! ```text
#![doc = include_str!("diagram.txt")]
//! ```

mod check;
mod config;
mod counts;
mod front;
mod memories;
mod processor;
mod units;

pub use check::{ConfigProblem, claim_3_warning, warnings};
pub use config::{BumpProcessorConfig, CacheConfigs, ClockConfig, FifoConfigs, MemoryConfigs, ReferenceConfig, ReferenceFilter};
pub use front::{FrontEnd, SceneFront, TraceFront};
pub use processor::BumpProcessor;
pub use units::{UNITS, UnitInfo};

/// Figure 1 in characters.
pub const DIAGRAM: &str = include_str!("diagram.txt");
