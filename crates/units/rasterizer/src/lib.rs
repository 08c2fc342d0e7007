//! Rasterizer: converts polygons to fragments. The distributor follows it.
//!
//! ```text
//!  polygons --> rasterizer --> (early z) --> distributor --+--> bump targets: normal-vector mapping unit (108)
//!                                                          +--> others: graphics processor (104)
//! ```
//!
//! The patent has no rasterizer of its own: "mapped to the polygon's pixels by ordinary texture mapping" presumes one (assumed: a
//! unit in front of the bump-mapping processor (106)).

pub mod config;
pub mod distributor;
pub mod state;
pub mod unit;
mod work;

pub use config::{RasterOrder, RasterizerConfig};
pub use distributor::{Distributor, DistributorState};
pub use state::{RasterizerCounters, RasterizerState};
pub use unit::Rasterizer;

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
