//! Arguments of the commands that do not simulate: `describe`, `compare`, `schema`.

use super::common::ViewArgs;
use super::values::{key_value, machine, output_file, tolerance};
use basrelief_sim::{MACHINES, MachineInfo};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Arguments of `describe`.
#[derive(Clone, Debug, Args)]
pub struct DescribeArgs {
    /// The machine.
    #[arg(value_parser = machine(), default_value = MACHINES[0].name)]
    pub machine: &'static MachineInfo,
    /// Show only units and parameters whose name contains this text, for example `memory.graphics`.
    #[arg(value_name = "FILTER", conflicts_with = "hardware")]
    pub filter: Option<String>,
    /// Parameter file (TOML or JSON), or a report.json, whose `config` is used. The table shows the resulting values.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Overrides one parameter; repeatable.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    pub settings: Vec<(String, String)>,
    /// Print the hardware cost instead: operators, tables, registers, caches and FIFOs, with their widths.
    #[arg(long)]
    pub hardware: bool,
    /// Print the table as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `compare`.
#[derive(Clone, Debug, Args)]
pub struct CompareArgs {
    /// The first report: report.json, or the folder that holds it. If every folder holds run.recording, the causes of the cycle
    /// difference are measured.
    pub a: PathBuf,
    /// The second report; each of several is compared with A.
    #[arg(required = true, value_name = "B")]
    pub others: Vec<PathBuf>,
    /// Exit with code 1 if one of these is worse than in A by more than this [%], or cannot be judged: cycles of the run or of a frame,
    /// moved bytes of a memory client, PSNR, SSIM or FLIP of an image. If the clocks differ, times are judged instead of cycles. Area
    /// is not judged.
    #[arg(long, value_name = "PERCENT", value_parser = tolerance)]
    pub fail_over: Option<f64>,
    /// With --fail-over, judge runs with different inputs too; without this option they fail.
    #[arg(long, requires = "fail_over")]
    pub allow_other_input: bool,
    /// Print the comparison as JSON; several comparisons form a list.
    #[arg(long)]
    pub json: bool,
    /// Write the comparison as an HTML page with causes, images and block diagrams, in one file.
    #[arg(long, value_name = "FILE", value_parser = output_file())]
    pub html: Option<PathBuf>,
    /// Measurement of the causes. Timing parameters need resimulations of the recordings, several work parameters need runs of
    /// --input.
    #[arg(long, value_enum, default_value_t)]
    pub explain: Explain,
    /// Model, trace or `demo:NAME` of both runs, with its view options, to measure work parameters one by one [default: the demo
    /// that the reports name, in its own view].
    #[arg(long, value_name = "INPUT")]
    pub input: Option<PathBuf>,
    #[command(flatten)]
    pub view: ViewArgs,
}

/// Causes that `compare` measures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Explain {
    /// No causes.
    None,
    /// Timing parameters one by one, and all work parameters together, by resimulation.
    Timing,
    /// Each parameter that the user changed. The machine runs again for single work parameters.
    #[default]
    All,
}

/// Arguments of `schema`.
#[derive(Clone, Debug, Args)]
pub struct SchemaArgs {
    /// The document that the schema describes.
    #[arg(value_enum)]
    pub of: SchemaName,
    /// The machine, for the schema of its parameters.
    #[arg(long, value_parser = machine(), default_value = MACHINES[0].name)]
    pub machine: &'static MachineInfo,
}

/// The documents that have a schema.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SchemaName {
    /// One line of a trace.
    Trace,
    /// A report (report.json).
    Report,
    /// The parameters of a machine.
    Config,
    /// A camera file (--camera).
    Camera,
    /// A view file (--views).
    Views,
    /// A plan of `sweep` and `explore`, whose axes are the parameters of the machine.
    Plan,
}
