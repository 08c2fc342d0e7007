//! Texture mapping system with the texel value generator (Sun Microsystems, 1994).
//!
//! Figure 3, as wired by [`TextureMappingSystem`]:
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
pub use basrelief_texel_value_generator::{DisplacementMap, FrameLog, SpanRecord};
pub use check::warnings;
pub use config::{CacheConfigs, FifoConfigs, MemoryConfigs, PixelValueBufferConfig, TexelMachineConfig};
pub use machine::TextureMappingSystem;
pub use spec::TexelLog;

/// Name of the machine.
pub const NAME: &str = "texel";

/// Figure 3 as text.
pub const DIAGRAM: &str = include_str!("diagram.txt");
