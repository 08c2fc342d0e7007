//! End-to-end tests of the built program: input files, output files, exit codes, messages.
//!
//! The pictures are small and the processes few, so all tests take seconds even in a debug build.

mod ablation;
mod bad_input;
#[cfg(unix)]
mod breaks;
mod comparisons;
mod compatibility;
mod costs;
mod defer;
#[cfg(unix)]
mod error_cures;
mod import_warnings;
mod interrupt;
mod json_config;
#[cfg(unix)]
mod limits;
mod machines;
#[cfg(unix)]
mod memory;
mod opengl;
mod outputs;
mod pages;
mod pictures;
mod plan_errors;
mod recordings;
mod relay;
mod remote;
mod reports;
mod requests;
mod samples;
mod sensitivity;
mod shaped;
mod support;
mod sweeps;
mod texel;
mod traces;
mod usage;
mod viewer;
mod watch;
mod wires;
