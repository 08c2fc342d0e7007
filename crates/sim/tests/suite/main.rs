//! Sessions: runs, recordings, costs, presets and builds.

mod build;
mod builds;
mod common;
mod comparison;
mod costs;
mod defer;
mod fifo_sizing;
mod ladder;
mod mesa;
mod presets;
mod resimulation;
mod round_trip;
