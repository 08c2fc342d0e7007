//! Figure shading device (Hitachi, 1986; JPH0772915B2).
//!
//! Figure 1, as wired by [`FigureShadingDevice`]:
//!
//! ```text
#![doc = include_str!("diagram.txt")]
//! ```

mod check;
mod config;
mod machine;
mod memories;
mod spec;

pub use crate::config::ClockConfig;
pub use crate::front::FrontEnd;
pub use crate::problem::ConfigProblem;
pub use check::warnings;
pub use config::{CacheConfigs, FifoConfigs, FrameMemoryConfig, MemoryConfigs, ShadeConfig};
pub use machine::FigureShadingDevice;

/// Name of the machine.
pub const NAME: &str = "shade";

/// Figure 1 as text.
pub const DIAGRAM: &str = include_str!("diagram.txt");
