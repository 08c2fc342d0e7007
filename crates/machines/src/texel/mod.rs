//! The texture mapping system with the texel value generator (Sun Microsystems, 1994).
//!
//! Figure 3, as it is wired by [`TextureMappingSystem`]:
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
pub use basrelief_texel_value_generator::{DisplacementMap, FrameLog, SpanRecord};
pub use check::warnings;
pub use config::{CacheConfigs, MemoryConfigs, PixelValueBufferConfig, TexelMachineConfig};
pub use fifos::FifoConfigs;
pub use machine::TextureMappingSystem;
pub use units::UNITS;

/// Name of the machine.
pub const NAME: &str = "texel";

/// Figure 3 in characters.
pub const DIAGRAM: &str = include_str!("diagram.txt");
