//! Brightness fetch unit (112): reads the brightness of each index from the CLUT (122) of its level, and interpolates between
//! levels.
//!
//! ```text
//! Flow<NormalIndexes> -> [ CLUTs up to date? | look up | weigh ] -> Flow<ShadedFragment>
//!                             |                  |
//!               client 1: recalculated entries   client 0: CLUT cache       both of memory (120)
//! ```
//!
//! A CLUT holds the brightness of every reference normal for an assumed light. If light, viewer, material or reference normals
//! change, the CLUTs are recalculated before the next fragment. The writes go through to the cache (assumed: it snoops them, so
//! no line is stale).

mod clut;
mod config;
mod sets;
mod state;
mod unit;

pub use clut::{ClutKey, ClutLevels};
pub use config::{BrightnessConfig, BrightnessSource, Components};
pub use state::{BrightnessFetchCounters, BrightnessFetchState};
pub use unit::BrightnessFetch;

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
