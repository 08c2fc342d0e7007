//! The quantized bump-mapping processor (Sony; inventor A. Ohba).
//!
//! Figure 1, as it is wired by [`BumpProcessor`]:
//!
//! ```text
#![doc = include_str!("diagram.txt")]
//! ```

mod check;
mod config;
mod machine;
mod memories;

pub use crate::config::{ClockConfig, ReferenceConfig, ReferenceFilter};
pub use crate::front::{FrontEnd, SceneFront, TraceFront};
pub use crate::problem::ConfigProblem;
pub use check::warnings;
pub use config::{BumpProcessorConfig, CacheConfigs, FifoConfigs, MemoryConfigs};
pub use machine::BumpProcessor;

/// Name of the machine.
pub const NAME: &str = "bump";

/// Figure 1 in characters.
pub const DIAGRAM: &str = include_str!("diagram.txt");

#[cfg(test)]
mod tests {
    use super::*;

    fn late_z() -> BumpProcessorConfig {
        let mut config = BumpProcessorConfig::default();
        config.rasterizer.early_z = false;
        config
    }

    crate::unit_info::checks_the_drawing!(BumpProcessor, [BumpProcessorConfig::default(), late_z()]);
}
