//! Sessions: runs, recordings, costs, presets and builds.

mod build;
mod builds;
mod common;
mod costs;
mod defer;
mod mesa;
mod presets;
mod resimulation;
mod round_trip;
