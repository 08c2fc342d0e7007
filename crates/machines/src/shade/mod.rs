//! The figure shading device (Hitachi, 1986; JPH0772915B2).
//!
//! Figure 1, as it is wired by [`FigureShadingDevice`]:
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
pub use config::{CacheConfigs, FrameMemoryConfig, MemoryConfigs, ShadeConfig};
pub use fifos::FifoConfigs;
pub use machine::FigureShadingDevice;
pub use units::UNITS;

/// Name of the machine.
pub const NAME: &str = "shade";

/// Figure 1 in characters.
pub const DIAGRAM: &str = include_str!("diagram.txt");
