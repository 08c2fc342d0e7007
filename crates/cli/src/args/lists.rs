//! Arguments of the commands that write and check display lists: `record`, `convert`, `verify`.

use super::common::{EngineName, MachineArgs, ViewArgs};
use clap::Args;
use std::path::PathBuf;

/// Arguments of `record`.
#[derive(Clone, Debug, Args)]
pub struct RecordArgs {
    /// A model, or `demo:NAME`.
    pub input: PathBuf,
    /// The display list to write: .jsonl or .bdl, with .zst compressed; `-` writes JSON Lines to standard output.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Simulate it too, and store cycles, bytes and picture hashes in it as expectations.
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
    /// The display list to read, in any form; `-` is standard input.
    pub input: PathBuf,
    /// The display list to write: .jsonl or .bdl, with .zst compressed; `-` writes JSON Lines to standard output.
    pub output: PathBuf,
}

/// Arguments of `verify`.
#[derive(Clone, Debug, Args)]
pub struct VerifyArgs {
    /// Traces, or folders of them.
    #[arg(required = true)]
    pub paths: Vec<PathBuf>,
    /// Write what the machine does now into the traces, instead of checking it. Review the difference.
    #[arg(long)]
    pub bless: bool,
    /// Check with this engine; without it, with both.
    #[arg(long, value_enum)]
    pub engine: Option<EngineName>,
}
