//! Analyses of runs: bottlenecks, ablation, methods, FIFO sizing, comparison of two runs, and attribution of cycles.

pub(crate) mod ablation;
pub(crate) mod attribution;
pub(crate) mod bottleneck;
pub(crate) mod comparison;
pub(crate) mod costs;
pub(crate) mod fifo_sizing;
pub(crate) mod methods;
pub(crate) mod picture_difference;
mod relaxations;
