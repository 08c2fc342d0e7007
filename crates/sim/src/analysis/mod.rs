//! Analyses of runs: bottlenecks, ablation, methods, FIFO sizing, comparison of two runs, and attribution of cycles.

pub(crate) mod ablation;
mod analysis_task;
pub(crate) mod attribution;
pub(crate) mod bottleneck;
pub(crate) mod comparison;
pub(crate) mod costs;
pub(crate) mod fifo_sizing;
mod ladder;
pub(crate) mod methods;
mod mixtures;
pub(crate) mod picture_difference;
pub(crate) mod recorded_run;
mod relaxations;
pub(crate) mod resimulations;
