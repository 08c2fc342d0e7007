//! Arguments of `sweep` and `explore`.

use super::values::{Shard, budget, percent, shard, whole};
use basrelief_dse::Budget;
use clap::Args;
use std::path::PathBuf;

/// The plan, and how to run its points.
#[derive(Clone, Debug, Args)]
pub struct PlanArgs {
    /// The plan, a TOML file with inputs, machine, axes and objectives. Paths in it are relative to the file.
    pub plan: PathBuf,
    /// Folder for results and tables; created if absent. Existing results are reused.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Parallel runs [default: one per core].
    #[arg(long, value_name = "N", value_parser = whole::<u16>(1..=u16::MAX.into()))]
    pub threads: Option<u16>,
    /// Write no images beside the reports.
    #[arg(long)]
    pub no_pictures: bool,
    /// Run failed points again.
    #[arg(long)]
    pub retry_failed: bool,
}

/// Arguments of `explore`.
#[derive(Clone, Debug, Args)]
pub struct ExploreArgs {
    #[command(flatten)]
    pub plan: PlanArgs,
    /// Maximum number of points to run, such as 40; or a time in seconds after which no round of points begins, such as 90s.
    #[arg(long, value_name = "N|SECONDSs", value_parser = budget)]
    pub budget: Budget,
    /// Choose differently among points that promise the same: 0 prefers the first in the plan.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = whole::<u32>(0..=u32::MAX.into()))]
    pub seed: u32,
}

/// Arguments of `sweep`.
#[derive(Clone, Debug, Args)]
pub struct SweepArgs {
    #[command(flatten)]
    pub plan: PlanArgs,
    /// Repeat this fraction of the points as full runs afterwards and compare the reports byte by byte; exit code 1 if one differs [%].
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    pub verify: Option<f64>,
    /// Run nothing; print commands for GNU parallel or xargs. Missing points that share a recording are in one command.
    #[arg(long, group = "instead")]
    pub list: bool,
    /// Run nothing; print a Slurm job script. `sh` submits it: an array runs the missing points, and a job that depends on it writes
    /// the tables.
    #[arg(long, group = "instead")]
    pub slurm: bool,
    /// Run only part I of N, from 1. Points that share a recording are in the same part.
    #[arg(long, value_name = "I/N", value_parser = shard, conflicts_with = "instead")]
    pub shard: Option<Shard>,
    /// Run only the point with this hash (see --list), and write no tables; repeatable.
    #[arg(long, value_name = "HASH", conflicts_with_all = ["instead", "shard"])]
    pub point: Vec<String>,
}
