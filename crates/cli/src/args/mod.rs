//! The command line. Every option says its unit of measure and its default; what is said here is what `--help` shows.

mod common;
mod describe;
mod lists;
mod run;
mod sweep;
mod values;

pub use common::{EngineName, MachineArgs, RequestsFormat, SimulationArgs, TablesArgs, TokenKind, ViewArgs};
pub use describe::{CompareArgs, DescribeArgs, SchemaArgs, SchemaName};
pub use lists::{ConvertArgs, RecordArgs, VerifyArgs};
pub use run::{DemoArgs, PageArgs, RetimeArgs, RunArgs, ServeArgs, SizeFifosArgs};
pub use sweep::{ExploreArgs, PlanArgs, Shard, SweepArgs};

use basrelief_input::{Budget, Size};
use clap::{Parser, Subcommand};

/// Cycle-level simulator of patented shading devices: what does this pipeline cost, why, and what picture do I get?
#[derive(Debug, Parser)]
#[command(name = "basrelief", version, max_term_width = 110, arg_required_else_help = true)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Print errors only.
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// Most memory that all that is read from files and servers may take, and what is made of it [bytes, or with KiB, MiB or
    /// GiB behind]. More is an error.
    #[arg(long, global = true, value_name = "BYTES", default_value_t = Size(Budget::DEFAULT))]
    pub memory_limit: Size,
    /// Let models name files outside their folders, with `../`. Without it such a name is an error.
    #[arg(long, global = true)]
    pub allow_outside: bool,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Draw an embedded scene and write picture, exact picture and report.
    Demo(DemoArgs),
    /// Draw a model (glTF 2.0, GLB, OBJ) or replay a recorded display list.
    Run(RunArgs),
    /// Time the recorded work of a run again, under other FIFOs, memories and caches.
    Retime(RetimeArgs),
    /// Find the smallest FIFOs that keep the cycles of runs.
    SizeFifos(SizeFifosArgs),
    /// Run all points of a plan, or what is missing of them, and find those that no other beats.
    Sweep(SweepArgs),
    /// Find the front of a plan with few of its points.
    Explore(ExploreArgs),
    /// Record what the geometry processor hands on as a display list.
    Record(RecordArgs),
    /// Turn a display list from one form into another (JSON Lines or binary, plain or zstd), without loss.
    Convert(ConvertArgs),
    /// Replay traces and check the expectations they carry.
    Verify(VerifyArgs),
    /// Show a machine: block diagram, units, parameters with unit, default and provenance.
    Describe(DescribeArgs),
    /// Say what changed between reports, largest first, and what explains it.
    Compare(CompareArgs),
    /// Print a JSON schema.
    Schema(SchemaArgs),
    /// Show the simulator as a page in a browser: pictures, figures and block diagram that follow every slider.
    Page(PageArgs),
    /// Offer meshes, texture sizes and single tiles of a scene over HTTP, for `run --from`.
    Serve(ServeArgs),
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
