//! The texture mapping system with the texel value generator (Sun Microsystems, 1994).
//!
//! Figure 3, as it is wired by [`TextureMappingSystem`]:
//!
//! ```text
#![doc = include_str!("diagram.txt")]
//! ```

mod check;
mod config;
mod machine;
mod memories;

pub use crate::config::ClockConfig;
pub use crate::front::{FrontEnd, SceneFront, TraceFront};
pub use crate::problem::ConfigProblem;
pub use basrelief_texel_value_generator::{DisplacementMap, FrameLog, SpanRecord};
pub use check::warnings;
pub use config::{CacheConfigs, FifoConfigs, MemoryConfigs, PixelValueBufferConfig, TexelMachineConfig};
pub use machine::TextureMappingSystem;

/// Name of the machine.
pub const NAME: &str = "texel";

/// Figure 3 in characters.
pub const DIAGRAM: &str = include_str!("diagram.txt");

#[cfg(test)]
mod tests {
    use super::*;

    fn without_depth_test() -> TexelMachineConfig {
        let mut config = TexelMachineConfig::default();
        config.pixel_value_buffer.depth_test = false;
        config
    }

    crate::unit_info::checks_the_drawing!(TextureMappingSystem, [TexelMachineConfig::default(), without_depth_test()]);
}
