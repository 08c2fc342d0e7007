//! Arguments of the commands that draw or offer scenes: `demo`, `run`, `serve`.

use super::common::{MachineArgs, SimulationArgs, TablesArgs, ViewArgs};
use super::values::{finite, http, key_value, socket};
use clap::Args;
use std::net::SocketAddr;
use std::path::PathBuf;

/// Arguments of `demo`.
#[derive(Clone, Debug, Args)]
pub struct DemoArgs {
    /// Which scene; `basrelief describe` lists all. Where none is named, the first that is made for the machine.
    pub name: Option<String>,
    #[command(flatten)]
    pub machine: MachineArgs,
    #[command(flatten)]
    pub simulation: SimulationArgs,
    #[command(flatten)]
    pub view: ViewArgs,
}

/// Arguments of `run`.
#[derive(Clone, Debug, Args)]
pub struct RunArgs {
    /// A model or a display list; `-` reads a display list from standard input.
    #[arg(required_unless_present = "from")]
    pub input: Option<PathBuf>,
    /// Render the scene of a server (`basrelief serve`) with machine defer, such as http://127.0.0.1:8080/, instead of a file, from
    /// any view. Without the exact picture: textures stay there. What does not come, or nothing of it for 10 s, is asked for again:
    /// five times in all, and not later than 20 s after the first.
    #[arg(long, value_name = "URL", conflicts_with_all = ["input", "ablate", "compare_methods", "sensitivity"], value_parser = http)]
    pub from: Option<String>,
    /// Longest that a server is waited for that does not listen yet (seconds) [default: 30].
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u64).range(..=86_400))]
    pub wait: Option<u64>,
    /// Keep tiles that have come in this folder, and take them from there.
    #[arg(long, value_name = "DIR")]
    pub tile_cache: Option<PathBuf>,
    #[command(flatten)]
    pub machine: MachineArgs,
    #[command(flatten)]
    pub simulation: SimulationArgs,
    #[command(flatten)]
    pub view: ViewArgs,
}

/// Arguments of `retime`.
#[derive(Clone, Debug, Args)]
pub struct RetimeArgs {
    /// The tape, made by `run --tape`, or a folder of a run that has left its run.tape there.
    pub tape: PathBuf,
    /// One parameter over those of the run, of those that change times only (`basrelief describe`); repeatable.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    pub settings: Vec<(String, String)>,
    /// Write report.json into this folder, and run.tape if its work is short.
    #[arg(long, short, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the report to standard output, and nothing else.
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub tables: TablesArgs,
    /// Write the tables as report.csv too.
    #[arg(long, requires = "out")]
    pub csv: bool,
    /// Write the report as one page, without pictures: a file that any browser shows.
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Measure what limits the run however many steps it makes.
    #[arg(long, conflicts_with = "no_limits")]
    pub limits: bool,
    /// Do not measure what limits the run, and leave no run.tape beside its report.
    #[arg(long)]
    pub no_limits: bool,
}

/// Arguments of `size-fifos`.
#[derive(Clone, Debug, Args)]
pub struct SizeFifosArgs {
    /// Models, display lists or `demo:NAME`, which are run; tapes, made by `run --tape`; or folders of runs that have left their
    /// run.tape there. All of one machine with the same parameters.
    #[arg(required = true)]
    pub inputs: Vec<PathBuf>,
    /// Cycles of the frames that may be lost (percent); several, with commas between, make a table.
    #[arg(long, value_name = "PERCENT", value_delimiter = ',', default_values_t = [0.0, 0.5, 2.0], value_parser = finite)]
    pub within: Vec<f64>,
    /// Print the table as JSON.
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub machine: MachineArgs,
    #[command(flatten)]
    pub view: ViewArgs,
}

/// Options of `page`.
#[derive(Debug, Args)]
pub struct PageArgs {
    /// Where; port 0 takes any that is free.
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8017", value_parser = socket)]
    pub listen: SocketAddr,
    /// Other computers may connect.
    #[arg(long)]
    pub public: bool,
    /// The folder that `web/build` has made; by itself it is looked for beside this program.
    #[arg(long, value_name = "DIR")]
    pub folder: Option<PathBuf>,
    /// Write the page as one file that works from a disk, and serve nothing.
    #[arg(long, value_name = "FILE.html", conflicts_with_all = ["listen", "public"])]
    pub export: Option<PathBuf>,
}

/// Arguments of `serve`.
#[derive(Clone, Debug, Args)]
pub struct ServeArgs {
    /// A model, or `demo:NAME`.
    pub input: PathBuf,
    /// Where; port 0 takes any that is free.
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8080", value_parser = socket)]
    pub listen: SocketAddr,
    /// Other computers may connect.
    #[arg(long)]
    pub public: bool,
    /// The folder that `web/build` has made, for who looks with a browser; by itself it is looked for beside this program.
    #[arg(long, value_name = "DIR")]
    pub folder: Option<PathBuf>,
}
