//! The command line. Every option says its unit of measure and its default; what is said here is what `--help` shows.

use basrelief_session::{MACHINES, MachineInfo};
use basrelief_signals::MAX_PICTURE_PIXELS;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{ArgAction, Args, Parser, Subcommand, ValueEnum};
use std::net::SocketAddr;
use std::path::PathBuf;

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
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Draw an embedded scene and write picture, exact picture and report.
    Demo(DemoArgs),
    /// Draw a model (glTF 2.0, GLB, OBJ) or replay a recorded display list.
    Run(RunArgs),
    /// Record what the geometry processor hands on as a display list.
    Record(RecordArgs),
    /// Turn a display list from one form into another (JSON Lines or binary, plain or zstd), without loss.
    Convert(ConvertArgs),
    /// Replay traces and check the expectations they carry.
    Verify(VerifyArgs),
    /// Show a machine: block diagram, units, parameters with unit, default and provenance.
    Describe(DescribeArgs),
    /// List what changed between two reports, largest first.
    Compare(CompareArgs),
    /// Print a JSON schema.
    Schema(SchemaArgs),
    /// Offer polygons, texture sizes and single tiles of a scene over HTTP, for `run --from`.
    Serve(ServeArgs),
}

/// The engines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum EngineName {
    /// Time-stamped dataflow: fast.
    #[default]
    Timed,
    /// Every unit in every cycle: slow, the oracle. The report is the same.
    Ticked,
}

/// Which machine, and how it is set up.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Machine")]
pub struct MachineArgs {
    /// The machine; where none is named, the one that the demo is made for, or bump.
    #[arg(long, value_parser = machine())]
    pub machine: Option<&'static MachineInfo>,
    /// Parameters from a TOML file.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// One parameter, over those of the file; repeatable. `basrelief describe` lists all.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    pub settings: Vec<(String, String)>,
}

/// How to look at a scene.
#[derive(Clone, Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "View (scenes only: a display list carries its own)")]
pub struct ViewArgs {
    /// Size of the picture [pixels; default 640x480].
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// View from a file: view_projection (row-major, clip = M [x y z 1]^T), to_light, to_viewer.
    #[arg(long, value_name = "FILE")]
    pub camera: Option<PathBuf>,
    /// Number of pictures.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub frames: Option<u32>,
    /// Turn the camera about the model by this much over all frames (degrees).
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, value_parser = finite)]
    pub orbit: Option<f64>,
    /// Direction to the light, in world space, instead of the scene's lights.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = direction)]
    pub light: Option<[f64; 3]>,
    /// Turn the light about the vertical axis by this much over all frames (degrees).
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, value_parser = finite)]
    pub light_orbit: Option<f64>,
}

/// How to simulate, and what to write.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Simulation")]
pub struct SimulationArgs {
    /// The engine.
    #[arg(long, value_enum, default_value_t)]
    pub engine: EngineName,
    /// No time: the same steps with memories that answer at once; the same picture, no cycles.
    #[arg(long, conflicts_with_all = ["engine", "max_cycles", "timeline"])]
    pub functional: bool,
    /// Stop after this many cycles, with exit code 1 and the state so far.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub max_cycles: Option<u64>,
    /// Folder for pictures and report; created where absent.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Print the report to standard output, and nothing else.
    #[arg(long)]
    pub json: bool,
    /// Do not draw the exact picture and measure against it: faster where only cycles matter.
    #[arg(long)]
    pub no_exact: bool,
    /// Write the tables as report.csv too.
    #[arg(long)]
    pub csv: bool,
    /// Write what every unit did when, as a Perfetto trace (open at ui.perfetto.dev).
    #[arg(long, value_name = "FILE")]
    pub timeline: Option<PathBuf>,
    /// Run the same input without each short cut of the machine in turn, and without any, and write the table of cycles and
    /// changes as ablation.json and ablation.csv, and nothing else.
    #[arg(long, conflicts_with_all = ["functional", "timeline", "csv", "dump"])]
    pub ablate: bool,
    /// Run the same input by each method of the machine at the same error, and write the table of divisions, cycles,
    /// displacements and PSNR as methods.json and methods.csv, and nothing else. Of machine texel.
    #[arg(long, conflicts_with_all = ["functional", "timeline", "csv", "dump", "ablate"])]
    pub compare_methods: bool,
    /// Write what the machine can tell beside its picture, as JSON Lines: `spans` (texel) with their division points,
    /// `reference-buffer` (defer), its textured pixels, or `tiles` (defer), those acquired or used again; repeatable.
    #[arg(long, num_args = 2, value_names = ["WHAT", "FILE"], action = ArgAction::Append)]
    pub dump: Vec<PathBuf>,
}

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
    /// Render from a server (`basrelief serve`) with machine defer, such as http://127.0.0.1:8080/, instead of a file. Without
    /// the exact picture: textures stay there.
    #[arg(long, value_name = "URL", conflicts_with_all = ["input", "ablate", "compare_methods"], value_parser = http)]
    pub from: Option<String>,
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

/// Arguments of `serve`.
#[derive(Clone, Debug, Args)]
pub struct ServeArgs {
    /// A model, or `demo:NAME`.
    pub input: PathBuf,
    /// Where; port 0 takes any that is free.
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8080")]
    pub listen: SocketAddr,
    /// Other computers may connect.
    #[arg(long)]
    pub public: bool,
    #[command(flatten)]
    pub machine: MachineArgs,
    #[command(flatten)]
    pub view: ViewArgs,
}

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

/// Arguments of `describe`.
#[derive(Clone, Debug, Args)]
pub struct DescribeArgs {
    /// The machine.
    #[arg(value_parser = machine(), default_value = MACHINES[0].name)]
    pub machine: &'static MachineInfo,
    /// Print the table of parameters as JSON.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `compare`.
#[derive(Clone, Debug, Args)]
pub struct CompareArgs {
    /// The report before: a report.json, or the folder that holds it.
    pub a: PathBuf,
    /// The report after.
    pub b: PathBuf,
    /// Exit with 1 if anything grew worse by more than this (percent).
    #[arg(long, value_name = "PERCENT", value_parser = finite)]
    pub fail_over: Option<f64>,
    /// Print the comparison as JSON.
    #[arg(long)]
    pub json: bool,
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

/// The name of a machine.
fn machine() -> impl TypedValueParser<Value = &'static MachineInfo> {
    let names = MACHINES.iter().map(|m| PossibleValue::new(m.name).help(m.about));
    PossibleValuesParser::new(names).try_map(|name| MachineInfo::named(&name))
}

fn http(url: &str) -> Result<String, String> {
    let host = url.strip_prefix("http://").ok_or("expected http://ADDRESS:PORT/")?;
    if host.trim_matches('/').is_empty() { Err("expected http://ADDRESS:PORT/".into()) } else { Ok(url.into()) }
}

fn key_value(text: &str) -> Result<(String, String), String> {
    let (key, value) = text.split_once('=').ok_or("expected KEY=VALUE, such as replacement.entries=64")?;
    Ok((key.trim().into(), value.trim().into()))
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let expected = "expected WIDTHxHEIGHT, each 1..=16384, such as 640x480";
    let (width, height) = text.split_once(['x', 'X']).ok_or(expected)?;
    let side = |s: &str| s.trim().parse::<u32>().ok().filter(|n| (1..=16384).contains(n)).ok_or(expected);
    let size = [side(width)?, side(height)?];
    if size.map(u64::from).iter().product::<u64>() > MAX_PICTURE_PIXELS {
        return Err(format!("expected at most {MAX_PICTURE_PIXELS} pixels, such as 3840x2160"));
    }
    Ok(size)
}

fn finite(text: &str) -> Result<f64, String> {
    text.parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(|| "expected a finite number".into())
}

fn direction(text: &str) -> Result<[f64; 3], String> {
    let expected = "expected X,Y,Z, not all zero, such as 0.4,0.8,0.45";
    let parts: Vec<f64> = text.split(',').map(|p| finite(p.trim())).collect::<Result<_, _>>().map_err(|_| expected)?;
    let vector: [f64; 3] = parts.try_into().map_err(|_| expected)?;
    if vector.iter().all(|c| *c == 0.0) { Err(expected.into()) } else { Ok(vector) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn values_are_checked_where_they_are_given() {
        assert_eq!(size("640x480"), Ok([640, 480]));
        assert!(size("0x480").is_err() && size("640").is_err() && size("99999x2").is_err() && size("16384x16384").is_err());
        assert_eq!(direction("1, -2,3.5"), Ok([1.0, -2.0, 3.5]));
        assert!(direction("0,0,0").is_err() && direction("1,2").is_err() && direction("1,NaN,2").is_err());
        assert_eq!(key_value("a.b=[1, 2]"), Ok(("a.b".into(), "[1, 2]".into())));
        assert!(key_value("a.b").is_err());
    }
}
