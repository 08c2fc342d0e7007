//! Arguments of `sweep`.

use super::values::{percent, shard};
use clap::Args;
use std::path::PathBuf;

/// A part of the points of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 1.
    pub number: usize,
    /// Of how many.
    pub count: usize,
}

/// Arguments of `sweep`.
#[derive(Clone, Debug, Args)]
pub struct SweepArgs {
    /// The plan, a TOML file: inputs, machine, axes, objectives. Files that it names lie relative to it.
    pub plan: PathBuf,
    /// Folder for the points and the tables; created where absent. What is there already is not run again, whoever has run it.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Points under way at a time [default: one for each core].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// Write no picture beside the report of each point.
    #[arg(long)]
    pub no_pictures: bool,
    /// Run points that failed again.
    #[arg(long)]
    pub retry_failed: bool,
    /// Then run this share of the points again, each as a whole, and compare bytes: exit code 1 if any comes out otherwise.
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    pub verify: Option<f64>,
    /// Run nothing; print a command for each point that is missing, for GNU parallel or xargs.
    #[arg(long, group = "instead")]
    pub list: bool,
    /// Run nothing; print a job script for Slurm that runs what is missing as an array.
    #[arg(long, group = "instead")]
    pub slurm: bool,
    /// Run part I of N alone, I from 1; points that share their work are in one part.
    #[arg(long, value_name = "I/N", value_parser = shard, conflicts_with = "instead")]
    pub shard: Option<Shard>,
    /// Run this point alone, by its hash as --list says it, and write no tables.
    #[arg(long, value_name = "HASH", conflicts_with_all = ["instead", "shard"])]
    pub point: Option<String>,
}
