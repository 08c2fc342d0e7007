//! The rate-limited renderer (HP, 1998; JP 2000-057370).
//!
//! Figure 1, as it is wired by [`DeferredRenderer`]:
//!
//! ```text
#![doc = include_str!("diagram.txt")]
//! ```

mod check;
mod config;
mod events;
mod machine;
mod memories;

pub use crate::config::ClockConfig;
pub use crate::front::{FrontEnd, SceneFront, TraceFront};
pub use crate::problem::ConfigProblem;
pub use check::warnings;
pub use config::{CacheConfigs, DeferConfig, FifoConfigs, MemoryConfigs};
pub use machine::DeferredRenderer;

/// Name of the machine.
pub const NAME: &str = "defer";

/// Figure 1 in characters.
pub const DIAGRAM: &str = include_str!("diagram.txt");

#[cfg(test)]
mod tests {
    use super::*;

    crate::unit_info::checks_the_drawing!(DeferredRenderer, [DeferConfig::default()]);
}
