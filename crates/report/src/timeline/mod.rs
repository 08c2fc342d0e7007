//! What every unit did when, for people to look at.
//!
//! | module | what it does |
//! |---|---|
//! | [`board`] | what there is to be shown of a machine, and what of it is |
//! | [`levels`] | what is counted |
//! | [`watcher`] | from what a probe is told to what is shown |
//! | [`perfetto`] | shows it as a trace for ui.perfetto.dev |
//! | [`waves`] | shows it as waves for GTKWave and Surfer |

pub mod board;
pub mod levels;
pub mod perfetto;
mod proto;
mod scale;
mod streams;
pub mod watcher;
pub mod waves;
mod wires;

pub use board::Board;
pub use levels::{Levels, RATE_CYCLES, Value};
pub use perfetto::Timeline;
pub use watcher::{Chart, State, Transfer, Watcher};
pub use waves::Waves;

#[cfg(test)]
mod tests;
#[cfg(test)]
mod waves_tests;
