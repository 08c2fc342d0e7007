//! Arguments of the commands that draw or serve scenes.

use super::common::{MachineArgs, SimulationArgs, TablesArgs, ViewArgs};
use super::values::{host_name, http, key_value, origin, output_file, socket, tolerance, whole};
use clap::Args;
use std::net::SocketAddr;
use std::path::PathBuf;

/// Arguments of `demo`.
#[derive(Clone, Debug, Args)]
pub struct DemoArgs {
    /// The scene; `basrelief describe` lists all. Default: the first demo of the machine.
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
    /// A model, a trace, or `demo:NAME`; `-` reads a trace from standard input.
    #[arg(required_unless_present = "from")]
    pub input: Option<PathBuf>,
    /// Render the scene of a server (`basrelief serve`), for example http://127.0.0.1:8080/, with machine defer. There is no
    /// reference image, because the textures stay on the server. A failed request, or one without data for 10 s, is repeated: at
    /// most five attempts, none later than 20 s after the first.
    #[arg(long, value_name = "URL", conflicts_with_all = ["input", "ablate", "compare_methods", "sensitivity"], value_parser = http)]
    pub from: Option<String>,
    /// Connection timeout: longest wait for a server that does not listen yet [s; default: 30].
    #[arg(long, value_name = "SECONDS", value_parser = whole::<u64>(0..=86_400))]
    pub wait: Option<u64>,
    /// Cache folder for tiles of the server.
    #[arg(long, value_name = "DIR")]
    pub tile_cache: Option<PathBuf>,
    #[command(flatten)]
    pub machine: MachineArgs,
    #[command(flatten)]
    pub simulation: SimulationArgs,
    #[command(flatten)]
    pub view: ViewArgs,
}

/// Arguments of `resimulate`.
#[derive(Clone, Debug, Args)]
pub struct ResimulateArgs {
    /// A recording, written by `run --recording`, or the folder of a run that holds run.recording.
    pub recording: PathBuf,
    /// Overrides one timing parameter of the run; repeatable. `basrelief describe` marks the timing parameters.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    pub settings: Vec<(String, String)>,
    /// Write report.json into this folder, and run.recording if the recording is short.
    #[arg(long, short, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print only the report, as JSON.
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub tables: TablesArgs,
    /// Also write the tables as report.csv.
    #[arg(long, requires = "out")]
    pub csv: bool,
    /// Write the report as an HTML page without images, in one file.
    #[arg(long, value_name = "FILE", value_parser = output_file())]
    pub html: Option<PathBuf>,
    /// Analyse bottlenecks, however long the recording.
    #[arg(long, conflicts_with = "no_bottlenecks")]
    pub bottlenecks: bool,
    /// Skip the bottleneck analysis, and write no run.recording beside the report.
    #[arg(long)]
    pub no_bottlenecks: bool,
}

/// Arguments of `size-fifos`.
#[derive(Clone, Debug, Args)]
pub struct SizeFifosArgs {
    /// Models, traces or `demo:NAME`, which are run; recordings, written by `run --recording`; or folders of runs that hold
    /// run.recording. All must have the same machine and parameters.
    #[arg(required = true)]
    pub inputs: Vec<PathBuf>,
    /// Allowed increase of the render cycles [%]; a comma-separated list gives one result per value.
    #[arg(long, value_name = "PERCENT", value_delimiter = ',', default_values_t = [0.1], value_parser = tolerance)]
    pub within: Vec<f64>,
    /// Print the result as JSON.
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
    /// Address and port of the server; port 0 selects a free port.
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8017", value_parser = socket)]
    pub listen: SocketAddr,
    /// Allow an address that other computers can reach.
    #[arg(long)]
    pub public: bool,
    /// Answer requests to this host name too; repeatable [default: the address only].
    #[arg(long, value_name = "NAME", value_parser = host_name)]
    pub allow_host: Vec<String>,
    /// Folder written by `web/build` [default: the page in this program, else `page` beside it].
    #[arg(long, value_name = "DIR")]
    pub folder: Option<PathBuf>,
    /// Write the page as one file that works without a server, and exit.
    #[arg(long, value_name = "FILE.html", conflicts_with_all = ["listen", "public", "allow_host"])]
    pub export: Option<PathBuf>,
}

/// Arguments of `serve`.
#[derive(Clone, Debug, Args)]
pub struct ServeArgs {
    /// A model or `demo:NAME`.
    pub input: PathBuf,
    /// Address and port of the server; port 0 selects a free port.
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8080", value_parser = socket)]
    pub listen: SocketAddr,
    /// Allow an address that other computers can reach.
    #[arg(long)]
    pub public: bool,
    /// Answer requests to this host name too; repeatable [default: the address only].
    #[arg(long, value_name = "NAME", value_parser = host_name)]
    pub allow_host: Vec<String>,
    /// Let web pages of this origin read the scene, for example http://localhost:3000; `*` means all pages.
    #[arg(long, value_name = "ORIGIN", value_parser = origin)]
    pub allow_origin: Option<String>,
    /// Folder written by `web/build`, for the viewer in a browser [default: the page in this program, else `page` beside it].
    #[arg(long, value_name = "DIR")]
    pub folder: Option<PathBuf>,
}
