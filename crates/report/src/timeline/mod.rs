//! What every unit did when, for people to look at.
//!
//! | module | what it does |
//! |---|---|
//! | [`board`] | what there is to be shown of a machine, and what of it is |
//! | [`levels`] | what is counted |
//! | [`watcher`] | from what a probe is told to what is shown |
//! | [`perfetto`] | shows it as a trace for ui.perfetto.dev |
//! | [`waves`] | shows it as waves for GTKWave and Surfer |
//! | [`tokens`] | shows the life of single tokens for Konata |

pub mod board;
pub mod levels;
pub mod perfetto;
mod proto;
mod scale;
mod streams;
pub mod tokens;
pub mod watcher;
pub mod waves;
mod wires;

pub use board::Board;
pub use levels::{Levels, RATE_CYCLES, Value};
pub use perfetto::Timeline;
pub use tokens::Tokens;
pub use watcher::{Chart, Life, State, Transfer, Watcher, Whose};
pub use waves::Waves;

#[cfg(test)]
mod tests;
#[cfg(test)]
mod tokens_tests;
#[cfg(test)]
mod waves_tests;
