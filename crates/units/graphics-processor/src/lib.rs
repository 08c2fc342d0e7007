//! Graphics processor (104): textures, blends with the brightness, and tests depth.
//!
//! ```text
//!  brightness fetch unit (112) --> shaded ----+
//!                                             +--> graphics processor (104) --> (z-test) --> frame buffer (126)
//!  distributor ---------------> fragments ----+           |                        |
//!                                                  texture cache, held      z-cache, z-buffer
//!                                                         +-- graphics-data memory (124) --+
//! ```

pub mod blend;
pub mod config;
pub mod depth_test;
mod hold;
pub mod state;
pub mod unit;
mod work;

pub use config::{DepthConfig, DrawOrder, GraphicsConfig, HeldEntry, MipFilter};
pub use depth_test::{DepthTest, DepthTestCounters, DepthTestState};
pub use state::{GraphicsProcessorCounters, GraphicsProcessorState, HeldItem, InputPhase};
pub use unit::GraphicsProcessor;

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
