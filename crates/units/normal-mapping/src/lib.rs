//! Normal-vector mapping unit (108): reads the normal map (118) of each selected MIP level and rotates it into the surface's
//! frame. The result is one pseudo-normal N' per fragment and level.
//!
//! ```text
//! Flow<Fragment> -> [ select levels | taps | filter | rotate | scale ] -> Flow<PseudoNormals>
//!                                      |
//!                          normal-map cache (client 0), memory (116)
//! ```

mod config;
mod distinct;
mod rotate;
mod state;
mod unit;
mod work;

pub use config::{FilterAt, NormalMappingConfig};
pub use distinct::DistinctCounter;
pub use state::{NormalMappingCounters, NormalMappingState};
pub use unit::NormalMapping;

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
