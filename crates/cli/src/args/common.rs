//! Arguments that several commands share.

use super::values::{
    TableSelection, angles, direction, finite, key_value, machine, output_file, size, socket, tables, token_file, wave_file,
    whole, wire_file, zoom,
};
use crate::commands::dump;
use basrelief_report::TableGroup;
use basrelief_sim::{MACHINES, MachineInfo};
use clap::{ArgAction, ArgGroup, Args, ValueEnum};
use std::net::SocketAddr;
use std::num::NonZeroU64;
use std::path::PathBuf;

/// The engines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum EngineName {
    /// Event-driven; skips idle cycles.
    #[default]
    Timed,
    /// Visits every unit in every cycle; slow. The reference: its reports equal those of the timed engine.
    Ticked,
}

/// File format of memory requests.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum RequestsFormat {
    /// One line per request: cycle,memory,client,operation,address,bytes.
    #[default]
    Csv,
    /// Trace of DRAMsim3, one line per burst: 0xADDRESS READ|WRITE CYCLE.
    Dramsim3,
    /// DRAM trace of Ramulator 1, one line per burst: 0xADDRESS R|W.
    Ramulator,
    /// LoadStoreTrace of Ramulator 2, one line per burst: LD|ST 0xADDRESS.
    Ramulator2,
}

/// The machine and its parameters.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Machine")]
pub struct MachineArgs {
    /// The machine [default: the machine of the demo, otherwise bump].
    #[arg(long, value_parser = machine())]
    pub machine: Option<&'static MachineInfo>,
    /// Parameter file (TOML or JSON), or a report.json, whose `config` is used.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Overrides one parameter; repeatable. `basrelief describe` lists the parameters.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    pub settings: Vec<(String, String)>,
}

/// The view of a scene.
#[derive(Clone, Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "View (scenes only: a trace has its own view)")]
pub struct ViewArgs {
    /// Image size [pixels; default: 640x480].
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size, allow_hyphen_values = true)]
    pub size: Option<[u32; 2]>,
    /// Camera file (JSON): view_projection (row-major, clip = M [x y z 1]^T), to_light, to_viewer.
    #[arg(long, value_name = "FILE")]
    pub camera: Option<PathBuf>,
    /// Rotates the camera about the model before all other options: around the vertical axis, then upwards (degrees).
    #[arg(long, value_name = "AROUND,UP", allow_hyphen_values = true, value_parser = angles)]
    pub turn: Option<[f64; 2]>,
    /// Zoom factor about the image centre.
    #[arg(long, value_name = "FACTOR", value_parser = zoom)]
    pub zoom: Option<f64>,
    /// Number of frames.
    #[arg(long, value_name = "N", value_parser = whole::<u32>(1..=1_000_000))]
    pub frames: Option<u32>,
    /// Rotates the camera about the model by this angle over all frames (degrees). Frame k of N, from 0, has turned by k / N of
    /// it, so one frame alone does not turn.
    #[arg(long, value_name = "DEGREES", value_parser = finite)]
    pub orbit: Option<f64>,
    /// Direction to the light in world space; replaces the lights of the scene.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = direction)]
    pub light: Option<[f64; 3]>,
    /// Rotates the light about the vertical axis by this angle over all frames (degrees). Frame k of N, from 0, has turned by k
    /// / N of it, so one frame alone does not turn.
    #[arg(long, value_name = "DEGREES", value_parser = finite)]
    pub light_orbit: Option<f64>,
    /// View file (TOML or JSON) with one frame per view: `views = [{ at_ms = 0, orbit = 0 }, { at_ms = 350, orbit = 30 }]`. Each view
    /// overrides camera, turn, zoom, orbit, light and light_orbit of the command line. `at_ms` is the time at which the user changes
    /// to the view; machine defer in progressive mode then abandons the previous view.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["frames", "orbit", "light_orbit"])]
    pub views: Option<PathBuf>,
}

/// The printed parts of a report.
#[derive(Clone, Debug, Args)]
pub struct TablesArgs {
    /// Also print these tables (comma-separated list).
    #[arg(long, value_name = "TABLES", value_delimiter = ',', value_parser = tables())]
    tables: Vec<TableSelection>,
}

impl TablesArgs {
    /// Returns the selected tables.
    pub fn selected_tables(&self) -> Vec<TableGroup> {
        self.tables.iter().flat_map(|named| named.0.clone()).collect()
    }

    /// Returns the tables that the user named, in the order of the report. `all` names none.
    pub fn named_tables(&self) -> impl Iterator<Item = TableGroup> {
        TableGroup::ALL.into_iter().filter(|table| self.tables.iter().any(|named| named.0 == [*table]))
    }
}

/// Kind of tokens in the file of `--tokens`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum TokenKind {
    /// Stamps, span packets or single pixels, depending on the machine.
    #[default]
    Fragments,
    /// Polygons until they are rasterized.
    Polygons,
}

/// Options of the simulation and its outputs.
#[derive(Clone, Debug, Args)]
#[command(
    next_help_heading = "Simulation",
    groups = [ArgGroup::new("time_line").multiple(true), ArgGroup::new("token_paths").multiple(true)],
)]
pub struct SimulationArgs {
    /// Simulation engine; both give the same report.
    #[arg(long, value_enum, default_value_t)]
    pub engine: EngineName,
    /// Functional mode: execute the units without timing. Same images, no cycles.
    #[arg(long, conflicts_with_all = ["engine", "max_cycles", "timeline", "waves", "tokens", "rtl", "requests", "costs", "bottlenecks"])]
    pub functional: bool,
    /// Stop after this many cycles with exit code 1; the report holds the state so far.
    #[arg(long, value_name = "N", value_parser = whole::<u64>(1..=u64::MAX))]
    pub max_cycles: Option<u64>,
    /// Folder for images and report; created if absent.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Print only the report, as JSON.
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub tables: TablesArgs,
    /// Skip the reference image and the quality figures; faster if only cycles matter.
    #[arg(long)]
    pub no_exact: bool,
    /// Analyse bottlenecks, however long the run: each unit, FIFO, memory and cache is made ideal in turn and the run is resimulated.
    /// Default: only if the recording is short.
    #[arg(long, conflicts_with = "no_bottlenecks")]
    pub bottlenecks: bool,
    /// Skip the bottleneck analysis, and write no run.recording beside the report.
    #[arg(long)]
    pub no_bottlenecks: bool,
    /// Sensitivity analysis: repeat the run with each assumed parameter changed, one at a time (numbers by half, others to their
    /// neighbours). The report lists the changes of cycles, time, bytes, area and decibels, largest first. About 300 runs on all
    /// cores; runs that differ in timing parameters only are resimulated.
    #[arg(long, conflicts_with_all = ["functional", "ablate", "compare_methods"])]
    pub sensitivity: bool,
    /// Also write the tables as report.csv.
    #[arg(long)]
    pub csv: bool,
    /// Attribute all unit cycles to pixels, polygons, objects and frames: tables in the report, and the images cost.png, wait.png,
    /// overdraw.png and, depending on the machine, level.png and entry.png. Needs about 8 bytes per pixel for each busy and wait cause
    /// of a unit.
    #[arg(long)]
    pub costs: bool,
    /// Write a timeline of all units as a Perfetto trace (open at ui.perfetto.dev). A name that ends in `.zst` compresses it; Perfetto reads
    /// it after `zstd -d`.
    #[arg(long, value_name = "FILE", value_parser = output_file(), groups = ["time_line", "token_paths"])]
    pub timeline: Option<PathBuf>,
    /// Write waveforms of all units and FIFOs as an FST file (open in GTKWave or Surfer). They stay in memory until the end of the run,
    /// within --memory-limit.
    #[arg(long, value_name = "FILE", value_parser = wave_file(), group = "time_line")]
    pub waves: Option<PathBuf>,
    /// Write the path of single tokens from unit to unit as a Kanata file (open in Konata): `.kanata`, or `.kanata.zst` compressed. A
    /// token that a test removes appears as flushed. The paths stay in memory until the end of the run, within --memory-limit.
    #[arg(long, value_name = "FILE", value_parser = token_file(), groups = ["time_line", "token_paths"])]
    pub tokens: Option<PathBuf>,
    /// Write everything that crosses the wires: tokens in bits, cycles of steps and deliveries, memory requests and answers, and tables. It
    /// checks register-transfer code of a unit against the machine (see rtl/check). Text: `.wires`, or `.wires.zst` compressed.
    #[arg(long, value_name = "FILE", value_parser = wire_file(), conflicts_with_all = ["time_line", "costs"])]
    pub rtl: Option<PathBuf>,
    /// Follow one token out of N, in the file of --tokens and in the flows of --timeline.
    #[arg(long, value_name = "N", requires = "token_paths", default_value = "64", value_parser = whole::<NonZeroU64>(1..=u64::MAX))]
    pub tokens_every: NonZeroU64,
    /// Kind of tokens to follow.
    #[arg(long, value_name = "WHAT", requires = "token_paths", value_enum, default_value_t)]
    pub tokens_of: TokenKind,
    /// First cycle of timeline, waveforms and tokens [default: 0].
    #[arg(long, value_name = "N", requires = "time_line", value_parser = whole::<u64>(0..=u64::MAX))]
    pub from_cycle: Option<u64>,
    /// End of timeline, waveforms and tokens (exclusive) [cycle; default: the end of the run].
    #[arg(long, value_name = "N", requires = "time_line", value_parser = whole::<u64>(1..=u64::MAX))]
    pub to_cycle: Option<u64>,
    /// Units in timeline, waveforms and tokens (comma-separated list), with their FIFOs and memories [default: all].
    #[arg(long, value_name = "NAME,NAME", requires = "time_line", value_delimiter = ',')]
    pub units: Vec<String>,
    /// Write the report as an HTML page with images and block diagram, in one file without scripts.
    #[arg(long, value_name = "FILE", value_parser = output_file())]
    pub html: Option<PathBuf>,
    /// Live preview in a browser at http://127.0.0.1:8018/ or at this loopback address: shows each frame as it finishes, and with
    /// --from as its tiles arrive. At its end the run waits up to 3 s for the browser to fetch the last image.
    #[arg(long, value_name = "ADDRESS:PORT", num_args = 0..=1, require_equals = true, default_missing_value = "127.0.0.1:8018",
          value_parser = socket, conflicts_with_all = ["ablate", "compare_methods"])]
    pub watch: Option<SocketAddr>,
    /// Write a recording of all steps, without times; `basrelief resimulate` computes its timing with other FIFOs, memories and caches.
    /// A short recording is always written as run.recording beside the report.
    #[arg(long, value_name = "FILE", value_parser = output_file(), conflicts_with = "functional")]
    pub recording: Option<PathBuf>,
    /// Write all memory requests, one memory after the other, in order of arrival cycle, then port, then issue. A name that ends in `.zst`
    /// compresses the file.
    #[arg(long, value_name = "FILE")]
    pub requests: Option<PathBuf>,
    /// File format of memory requests.
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t, requires = "requests")]
    pub requests_format: RequestsFormat,
    /// Write the requests of this memory only. Required for formats of other simulators if the machine has several memories.
    #[arg(long, value_name = "NAME", requires = "requests")]
    pub requests_memory: Option<String>,
    /// Ablation: run the input with each short cut of the machine switched off in turn, and with all off. Writes only ablation.json and
    /// ablation.csv.
    #[arg(long, conflicts_with_all = ["functional", "timeline", "waves", "tokens", "rtl", "html", "recording", "requests", "costs", "csv", "dump"])]
    pub ablate: bool,
    #[arg(long, help = methods_help(), conflicts_with_all = ["functional", "timeline", "waves", "tokens", "rtl", "html", "recording", "requests", "costs", "csv", "dump", "ablate"])]
    pub compare_methods: bool,
    #[arg(long, help = dump::help(), num_args = 2, value_names = ["WHAT", "FILE"], action = ArgAction::Append)]
    pub dump: Vec<PathBuf>,
}

/// Returns the help text of `--compare-methods`.
fn methods_help() -> String {
    let with: Vec<&str> = MACHINES.iter().filter(|m| m.has_methods).map(|m| m.name).collect();
    format!(
        "Run the input with each division method of the machine at the same error. Writes only methods.json and methods.csv with divisions, cycles, displacements and PSNR. Of machine {}",
        with.join(", ")
    )
}
