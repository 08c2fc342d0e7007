//! Activity of every unit in each cycle, as files for trace and wave viewers.
//!
//! | module | contents |
//! |---|---|
//! | [`layout`] | the machine and the part of its run that a time line shows |
//! | [`levels`] | counters of a time line |
//! | [`probe`] | the probe: turns events of a run into calls of each chart |
//! | [`perfetto`] | trace for ui.perfetto.dev |
//! | [`fst`] | FST waves for GTKWave and Surfer |
//! | [`kanata`] | life of single tokens for Konata |
//! | `compressed` | charts compressed with zstd, with this feature |
//! | [`wire_log`] | tokens and cycles of every wire, for register-transfer code |
//! | [`steps`] | steps and waits as a list |
//! | [`utilization`] | utilization over time in about a thousand columns |
//!
//! This crate opens no file, reads no clock and prints nothing: writers are arguments.

#[cfg(feature = "zstd")]
mod compressed;
pub mod fst;
pub mod kanata;
pub mod layout;
pub mod levels;
pub mod perfetto;
pub mod probe;
mod proto;
#[cfg(test)]
mod samples;
mod scale;
pub mod steps;
mod streams;
pub mod utilization;
pub mod wire_log;
mod wires;

#[cfg(feature = "zstd")]
pub use compressed::{CompressedChart, NamedOutput};
pub use fst::FstWaves;
pub use kanata::KanataLog;
pub use layout::TimelineLayout;
pub use levels::{CounterList, CounterValue, RATE_CYCLES};
pub use perfetto::PerfettoTrace;
pub use probe::{AttributedProbe, BusTransfer, StepAttribution, TimelineProbe, TokenLife, TraceSink, UnitState};
pub use steps::{StepList, TimelineStep};
pub use utilization::UtilizationTimeline;
pub use wire_log::WireLog;

#[cfg(test)]
mod fst_tests;
#[cfg(test)]
mod kanata_tests;
#[cfg(test)]
mod tests;

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
