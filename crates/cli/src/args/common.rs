//! Arguments that several commands have.

use super::values::{Named, angles, direction, finite, key_value, machine, size, socket, tables};
use crate::commands::{dump, tables as of_tables};
use basrelief_report::Tables;
use basrelief_sim::MachineInfo;
use clap::{ArgAction, ArgGroup, Args, ValueEnum};
use std::net::SocketAddr;
use std::num::NonZeroU64;
use std::path::PathBuf;

/// The engines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum EngineName {
    /// Time-stamped dataflow: fast.
    #[default]
    Timed,
    /// Every unit in every cycle: slow, the oracle. The report is the same.
    Ticked,
}

/// How requests are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum RequestsFormat {
    /// A line for each request: cycle,memory,client,operation,address,bytes.
    #[default]
    Csv,
    /// DRAMsim3's trace, a line for each burst: 0xADDRESS READ|WRITE CYCLE.
    Dramsim3,
    /// DRAM trace of Ramulator 1, a line for each burst: 0xADDRESS R|W.
    Ramulator,
    /// LoadStoreTrace of Ramulator 2, a line for each burst: LD|ST 0xADDRESS.
    Ramulator2,
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
    /// Turn the camera about the model, ahead of everything else: around the vertical axis, then upwards (degrees).
    #[arg(long, value_name = "AROUND,UP", allow_hyphen_values = true, value_parser = angles)]
    pub turn: Option<[f64; 2]>,
    /// See all so much larger, around the middle of the picture.
    #[arg(long, value_name = "FACTOR", value_parser = finite)]
    pub zoom: Option<f64>,
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
    /// Views one after the other, a picture of each, from a TOML or JSON file: `views = [{ at_ms = 0, orbit = 0 }, { at_ms = 350, orbit =
    /// 30 }]`, with camera, turn, zoom, orbit, light, light_orbit over the options here. `at_ms`: when the user turns to each; machine
    /// defer in the progressive mode leaves the one before then.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["frames", "orbit", "light_orbit"])]
    pub views: Option<PathBuf>,
}

/// What is printed of a report.
#[derive(Clone, Debug, Args)]
pub struct TablesArgs {
    /// Print these tables too, with commas between.
    #[arg(long, value_name = "TABLES", value_delimiter = ',', value_parser = tables())]
    tables: Vec<Named>,
}

impl TablesArgs {
    /// The tables that are wanted.
    pub fn shown(&self) -> Vec<Tables> {
        self.tables.iter().flat_map(|named| named.0.clone()).collect()
    }
}

/// Tokens whose life is told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum TokenKind {
    /// What polygons are drawn as: stamps of pixels, packets of a span or single pixels, as the machine has them.
    #[default]
    Fragments,
    /// Polygons, until they are drawn.
    Polygons,
}

/// How to simulate, and what to write.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Simulation", group = ArgGroup::new("time_line").multiple(true))]
pub struct SimulationArgs {
    /// The engine.
    #[arg(long, value_enum, default_value_t)]
    pub engine: EngineName,
    /// No time: the same steps with memories that answer at once; the same picture, no cycles.
    #[arg(long, conflicts_with_all = ["engine", "max_cycles", "timeline", "waves", "tokens", "requests", "costs"])]
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
    #[command(flatten)]
    pub tables: TablesArgs,
    /// Do not draw the exact picture and measure against it: faster where only cycles matter.
    #[arg(long)]
    pub no_exact: bool,
    /// Measure what limits the run however many steps it makes: each unit, FIFO, memory and cache is made ideal in turn, and the run
    /// timed again. By itself it is measured where that takes little time beside the pictures.
    #[arg(long, conflicts_with = "no_limits")]
    pub limits: bool,
    /// Do not measure what limits the run, and leave no run.tape beside its report.
    #[arg(long)]
    pub no_limits: bool,
    /// Then run the input again with every assumed parameter changed, one at a time: numbers by half, others to their neighbours. The
    /// report says how far cycles, bytes and decibels move, largest first. Some 300 runs, on all cores; those that differ in times only
    /// are timed again.
    #[arg(long, conflicts_with_all = ["functional", "ablate", "compare_methods"])]
    pub sensitivity: bool,
    /// Write the tables as report.csv too.
    #[arg(long)]
    pub csv: bool,
    /// Add up what each pixel, polygon, object and frame costs, cycle by cycle of every unit: cost.png, wait.png, overdraw.png and, of
    /// machines that have them, level.png and entry.png; and tables in the report. Takes some 8 bytes per pixel for each thing that a
    /// unit does or waits for.
    #[arg(long)]
    pub costs: bool,
    /// Write what every unit did when, as a Perfetto trace (open at ui.perfetto.dev).
    #[arg(long, value_name = "FILE", group = "time_line")]
    pub timeline: Option<PathBuf>,
    /// Write what every unit and FIFO did when as waves, a file in the format FST (open in GTKWave or Surfer). What they show is kept until
    /// the end of the run, within --memory-limit.
    #[arg(long, value_name = "FILE", group = "time_line")]
    pub waves: Option<PathBuf>,
    /// Write the life of single tokens, from unit to unit, as Konata shows that of instructions: `.kanata`, or `.kanata.zst` compressed. A
    /// token that a test removes is flushed. Kept until the end of the run, within --memory-limit.
    #[arg(long, value_name = "FILE", group = "time_line")]
    pub tokens: Option<PathBuf>,
    /// Tell the life of one token of so many.
    #[arg(long, value_name = "N", requires = "tokens", default_value = "64")]
    pub tokens_every: NonZeroU64,
    /// The tokens whose life is told.
    #[arg(long, value_name = "WHAT", requires = "tokens", value_enum, default_value_t)]
    pub tokens_of: TokenKind,
    /// The first cycle that time line, waves and tokens show [default: 0].
    #[arg(long, value_name = "N", requires = "time_line")]
    pub from_cycle: Option<u64>,
    /// The first cycle after those that time line, waves and tokens show [default: the end of the run].
    #[arg(long, value_name = "N", requires = "time_line", value_parser = clap::value_parser!(u64).range(1..))]
    pub to_cycle: Option<u64>,
    /// The units that time line, waves and tokens show, with the FIFOs at their ends and the memories that they use; several with commas
    /// between [default: all].
    #[arg(long, value_name = "NAME,NAME", requires = "time_line", value_delimiter = ',')]
    pub units: Vec<String>,
    /// Write the report as one page, with pictures and block diagram: a file that any browser shows, without script, and with
    /// nothing from outside.
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Show each picture in a browser when it is there, at http://127.0.0.1:8018/ or where ADDRESS:PORT says, on this computer; with
    /// --from as its tiles come. A run that is over stays until who watches has the last picture, 3 s at most.
    #[arg(long, value_name = "ADDRESS:PORT", num_args = 0..=1, require_equals = true, default_missing_value = "127.0.0.1:8018",
          value_parser = socket, conflicts_with_all = ["ablate", "compare_methods"])]
    pub watch: Option<SocketAddr>,
    /// Write what every unit did, without times: `basrelief retime` times it again under other FIFOs, memories and caches. By itself
    /// it is left as run.tape beside the report, if the work is short.
    #[arg(long, value_name = "FILE", conflicts_with = "functional")]
    pub tape: Option<PathBuf>,
    /// Write every memory request, the memories one after the other, each in the order in which it took them in: by cycle of
    /// arrival, then port, then issue.
    #[arg(long, value_name = "FILE")]
    pub requests: Option<PathBuf>,
    /// How requests are written.
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t, requires = "requests")]
    pub requests_format: RequestsFormat,
    /// Write the requests of this memory alone; needed by the formats of other simulators, which know one memory, where the
    /// machine has several.
    #[arg(long, value_name = "NAME", requires = "requests")]
    pub requests_memory: Option<String>,
    /// Run the same input without each short cut of the machine in turn, and without any, and write the table of cycles and
    /// changes as ablation.json and ablation.csv, and nothing else.
    #[arg(long, conflicts_with_all = ["functional", "timeline", "waves", "tokens", "html", "tape", "requests", "costs", "csv", "dump"])]
    pub ablate: bool,
    #[arg(long, help = of_tables::methods_help(), conflicts_with_all = ["functional", "timeline", "waves", "tokens", "html", "tape", "requests", "costs", "csv", "dump", "ablate"])]
    pub compare_methods: bool,
    #[arg(long, help = dump::help(), num_args = 2, value_names = ["WHAT", "FILE"], action = ArgAction::Append)]
    pub dump: Vec<PathBuf>,
}
