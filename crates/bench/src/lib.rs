//! All workloads, and their measuring commands.
//!
//! | measurement | command |
//! |---|---|
//! | criterion, all workloads | `cargo bench` |
//! | ratios within one run, as a table and as JSON | `cargo run --release -p basrelief-bench --example measure -- ratios --json FILE` |
//! | instructions against the committed budgets | `cargo run --release -p basrelief-bench --example measure -- instructions` |
//! | new budgets | `cargo run --release -p basrelief-bench --example measure -- instructions --bless` |
//! | W1 beside the same picture without any architecture | `cargo run --release -p basrelief-bench --example limit` |
//! | hostile runs of the program, as a table | `cargo run --release -p basrelief-bench --example hostile -- target/release/basrelief` |
//! | a trace of N polygons on standard output | `cargo run --release -p basrelief-bench --example measure -- trace N` |
//!
//! `measure` is an example, not a binary, so that the workspace has one binary and `cargo run` is unambiguous.

pub mod graphs;
pub mod hostile;
pub mod instructions;
pub mod machines;
pub mod models;
pub mod ratios;
pub mod stopwatch;
pub mod traces;
pub mod workload;

use workload::{Workload, WorkloadSize};

/// Returns all workloads except the single units, which exist at full size only.
pub fn workloads(size: WorkloadSize) -> Vec<Workload> {
    [graphs::workloads(size), machines::workloads(size), traces::workloads(size), models::workloads(size)]
        .into_iter()
        .flatten()
        .collect()
}
