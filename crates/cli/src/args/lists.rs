//! Arguments of the commands that write and check traces: `record`, `convert`, `verify`.

use super::common::{EngineName, MachineArgs, ViewArgs};
use clap::Args;
use std::path::PathBuf;

/// Arguments of `record`.
#[derive(Clone, Debug, Args)]
pub struct RecordArgs {
    /// A model or `demo:NAME`.
    pub input: PathBuf,
    /// The trace to write: .jsonl or .bdl, or either with .zst appended; `-` writes JSON Lines to standard output.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Simulate the trace and store its cycles, bytes and image hashes as expectations.
    #[arg(long)]
    pub expect: bool,
    #[command(flatten)]
    pub machine: MachineArgs,
    #[command(flatten)]
    pub view: ViewArgs,
}

/// Arguments of `convert`.
#[derive(Clone, Debug, Args)]
pub struct ConvertArgs {
    /// The trace to read, in any form; `-` is standard input.
    pub input: PathBuf,
    /// The trace to write: .jsonl or .bdl, or either with .zst appended; `-` writes JSON Lines to standard output.
    pub output: PathBuf,
}

/// Arguments of `verify`.
#[derive(Clone, Debug, Args)]
pub struct VerifyArgs {
    /// Traces or folders of traces.
    #[arg(required = true)]
    pub paths: Vec<PathBuf>,
    /// Write the current results into the traces instead of checking them. Review the difference.
    #[arg(long)]
    pub bless: bool,
    /// Check with this engine only [default: both].
    #[arg(long, value_enum)]
    pub engine: Option<EngineName>,
}
