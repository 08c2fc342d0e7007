//! Arguments of the commands that simulate nothing: `describe`, `compare`, `schema`.

use super::values::{finite, key_value, machine};
use basrelief_sim::{MACHINES, MachineInfo};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Arguments of `describe`.
#[derive(Clone, Debug, Args)]
pub struct DescribeArgs {
    /// The machine.
    #[arg(value_parser = machine(), default_value = MACHINES[0].name)]
    pub machine: &'static MachineInfo,
    /// Parameters from a TOML file: the table then shows what they come to.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// One parameter, over those of the file; repeatable.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    pub settings: Vec<(String, String)>,
    /// Print what the machine is built of instead: operators, tables, registers, caches and FIFOs, each with its width.
    #[arg(long)]
    pub hardware: bool,
    /// Print the table of parameters, or of the hardware, as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `compare`.
#[derive(Clone, Debug, Args)]
pub struct CompareArgs {
    /// The report before: a report.json, or the folder that holds it. Where both runs have left their run.tape beside it, what
    /// explains the difference in cycles is measured.
    pub a: PathBuf,
    /// The report after; of several, each is held against A.
    #[arg(required = true, value_name = "B")]
    pub others: Vec<PathBuf>,
    /// Exit with 1 if anything grew worse by more than this in any of them (percent).
    #[arg(long, value_name = "PERCENT", value_parser = finite)]
    pub fail_over: Option<f64>,
    /// Print the comparison as JSON; of several, a list of them.
    #[arg(long)]
    pub json: bool,
    /// Write the comparison as one page, with what explains it, and pictures and block diagrams of both.
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
}

/// Arguments of `schema`.
#[derive(Clone, Debug, Args)]
pub struct SchemaArgs {
    /// Of what.
    #[arg(value_enum)]
    pub of: SchemaName,
    /// The machine whose parameters are meant.
    #[arg(long, value_parser = machine(), default_value = MACHINES[0].name)]
    pub machine: &'static MachineInfo,
}

/// What has a schema.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SchemaName {
    /// One line of a display list.
    Trace,
    /// report.json.
    Report,
    /// The machine's parameters.
    Config,
    /// A `--camera` file.
    Camera,
}
