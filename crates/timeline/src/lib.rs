//! Activity of every unit in each cycle, as files for trace and wave viewers.
//!
//! | module | contents |
//! |---|---|
//! | [`board`] | the machine and the part of its run that a time line shows |
//! | [`levels`] | counters of a time line |
//! | [`watcher`] | the probe: turns events of a run into calls of each chart |
//! | [`perfetto`] | trace for ui.perfetto.dev |
//! | [`waves`] | FST waves for GTKWave and Surfer |
//! | [`tokens`] | life of single tokens for Konata |
//! | [`strips`] | utilization over time in about a thousand columns |
//!
//! This crate opens no file, reads no clock and prints nothing: writers are arguments.

pub mod board;
pub mod levels;
pub mod perfetto;
mod proto;
#[cfg(test)]
mod samples;
mod scale;
mod streams;
pub mod strips;
pub mod tokens;
pub mod watcher;
pub mod waves;
mod wires;

pub use board::Board;
pub use levels::{Levels, RATE_CYCLES, Value};
pub use perfetto::Timeline;
pub use strips::Strips;
pub use tokens::Tokens;
pub use watcher::{Chart, Life, State, Transfer, Watcher, Whose};
pub use waves::Waves;

#[cfg(test)]
mod tests;
#[cfg(test)]
mod tokens_tests;
#[cfg(test)]
mod waves_tests;
