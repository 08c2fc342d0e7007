//! Interface between a machine and the programs that run it.

use crate::defer::RunAhead;
use crate::draws::PictureMachine;
use crate::engines::MachineEngines as _;
use crate::front::{FrontConfig, FrontEnd};
use crate::methods::MethodSpecs;
use crate::problem::ConfigProblem;
use crate::unit_info::{UnitInfo, units};
use basrelief_deferred_renderer::{PicturePreview, TileFormat, TileSource};
use basrelief_frame_buffer::FinishedFrame;
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{AreaModel, Hardware, Netlist, RunReport};
use basrelief_parameters::Parameters;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt::Debug;

/// Name of a shortcut, and a function that disables it.
pub type Shortcut<S> = (&'static str, fn(&mut S));

/// Configuration of a machine: names the machine, and builds it behind either kind of input.
pub trait MachineSpec: Parameters + JsonSchema + Clone + Debug + PartialEq + Sync + 'static {
    /// Name, as in `--machine NAME`.
    const NAME: &'static str;
    /// Description in a few words.
    const ABOUT: &'static str;
    /// The patent's block diagram, as [`BlockDiagram`](crate::BlockDiagram) reads it.
    const DIAGRAM: &'static str;
    /// Demo scenes made for this machine. The first one is the default.
    const DEMOS: &'static [&'static str];
    /// Shortcuts that an ablation disables.
    const SHORTCUTS: &'static [Shortcut<Self>] = &[];
    /// FIFOs at which fragments are created and finished.
    const COST_POINTS: CostPoints;
    /// Methods that do the same work within the same error bound.
    const METHODS: Option<MethodSpecs<Self>> = None;
    /// True if textures come from a server over a path.
    const FETCHES_TILES: bool = false;
    /// Parameter with the times at which the user leaves each view.
    const LEFT_AT: Option<&'static str> = None;
    /// Stage that takes one tile per step. Empty if no view is ever left.
    const TAKES_TILES: &'static str = "";
    /// Memory per pixel of a picture in progress \[bytes\]: cells, colour and depth, the finished picture, and its file. Measured on
    /// covered pictures of several frames: 16, and 64 with `defer`.
    const PIXEL_BYTES: u64 = 24;
    /// Copies of each texture's texels that the machine and its reference image make.
    const TEXTURE_COPIES: u64 = 0;
    /// The machine.
    type Machine: LoggingMachine<Self::Log>;
    /// Entry of the machine's log, from which auxiliary outputs are made.
    type Log: 'static;

    /// Builds the machine at power-on.
    ///
    /// # Errors
    /// Parameters that are in range but do not fit together.
    fn build(&self, front: FrontEnd) -> Result<Self::Machine, ConfigProblem>;
    /// Builds the machine with tiles from a server. A machine that fetches no tiles ignores them.
    ///
    /// # Errors
    /// Parameters that are in range but do not fit together.
    fn build_remote(&self, front: FrontEnd, tiles: Box<dyn TileSource>) -> Result<Self::Machine, ConfigProblem> {
        drop(tiles);
        self.build(front)
    }
    /// Returns the units of the block diagram.
    fn units() -> Vec<UnitInfo> {
        let spec = Self::default();
        // The default configuration can always be built.
        let machines = empty_machine(&spec).ok().zip(empty_trace_machine(&spec).ok());
        machines.map_or(vec![], |(mut scene, mut trace)| units(Self::DIAGRAM, &mut scene, &mut trace))
    }
    /// Returns the hardware of the machine as configured.
    ///
    /// # Errors
    /// Parameters that are in range but do not fit together.
    fn hardware(&self) -> Result<Vec<Hardware>, ConfigProblem> {
        Ok(empty_machine(self)?.facts().all_hardware().to_vec())
    }
    /// Returns the data that give the area of the hardware.
    fn area_model(&self) -> AreaModel;
    /// Returns how the machine requests tiles; `None` if it fetches none.
    fn tile_fetch(&self) -> Option<TileFetch> {
        None
    }
    /// Returns the colouring of partial pictures; `None` if the machine fetches no tiles.
    fn preview(&self) -> Option<PicturePreview> {
        None
    }
    /// Returns the configuration of the front end.
    fn front(&self) -> FrontConfig;
    /// Returns warnings for the report, one sentence each.
    fn warnings(&self, facts: &UnitStats) -> Vec<String>;
    /// Adds figures that the machine alone cannot know: those of finished pictures and of time.
    fn figures(&self, summary: &RunSummary<'_>, facts: &mut UnitStats) {
        let _ = (summary, facts);
    }

    /// True if the user leaves views at given times. Preliminary runs must then find the tile counts at those times.
    fn acts_at_times(&self) -> bool {
        false
    }
    /// Returns the machine for the first preliminary run, in which no view is left.
    #[must_use]
    fn never_left(&self, views: usize) -> Self {
        let _ = views;
        self.clone()
    }
    /// Returns the machine with one more view left, according to a preliminary run; `None` if no view remains.
    #[must_use]
    fn left_once_more(&self, ahead: &RunAhead) -> Option<Self> {
        let _ = ahead;
        None
    }

    /// True if a frame may be shown in several pictures of increasing quality.
    fn shows_rounds(&self) -> bool {
        false
    }
}

/// FIFOs at which the fragments of a machine are created and finished, by name.
#[derive(Clone, Copy, Debug)]
pub struct CostPoints {
    /// FIFO that each fragment enters first.
    pub drawn: &'static str,
    /// FIFO that visible pixels end in: the first in this list that the configured machine has.
    pub shown: &'static [&'static str],
}

/// Tile requests of a machine.
#[derive(Clone, Debug, PartialEq)]
pub struct TileFetch {
    /// Size and encoding of the tiles.
    pub format: TileFormat,
    /// Requests in flight.
    pub requests: u32,
    /// Maximum number of tiles per request.
    pub tiles_per_request: u32,
    /// Times at which the user leaves each view \[ms from the start\].
    pub left_at_ms: Vec<f64>,
}

/// A picture that the machine has shown.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PictureRecord {
    /// Number of its frame.
    pub frame: u32,
    /// Number within its frame, from 0.
    pub round: u32,
    /// PSNR against the last picture of its frame \[dB\].
    pub psnr_db: f64,
    /// True for the last picture of its frame.
    pub last: bool,
}

/// Timing and pictures of a finished run.
#[derive(Clone, Copy, Debug)]
pub struct RunSummary<'a> {
    /// Report of the engine; `None` for the functional model.
    pub run: Option<&'a RunReport>,
    /// All pictures, in order.
    pub pictures: &'a [PictureRecord],
}

impl RunSummary<'_> {
    /// Returns the cycles from the end of the previous frame to each picture.
    pub fn cycles_of_frames(&self, run: &RunReport) -> Vec<u64> {
        let mut since = 0;
        let cycles = self.pictures.iter().zip(&run.marks).map(|(shown, cycles)| {
            let own = since + cycles;
            since = if shown.last { 0 } else { own };
            own
        });
        cycles.collect()
    }
}

/// A machine with a log and with pictures of increasing quality; both are empty by default. `L` is an entry of the log.
pub trait LoggingMachine<L>: PictureMachine {
    /// Returns the pictures shown since the last call that a better picture of the same frame follows, in order.
    fn drain_rounds(&mut self) -> Vec<FinishedFrame> {
        vec![]
    }
    /// Enables the log. Must be called before the first step.
    fn keep_log(&mut self) {}
    /// Removes and returns the entries since the last call, in order, each with its frame number. `finished` holds the frames
    /// finished since then.
    fn drain_log(&mut self, finished: &[FinishedFrame]) -> Vec<(u32, L)> {
        let _ = finished;
        vec![]
    }
    /// Returns the entry for the end of the run.
    fn last_log(&mut self) -> Option<L> {
        None
    }
    /// Returns a sentence about lost input that keeps the machine from finishing, such as a lost connection.
    fn lost(&self) -> Option<String> {
        None
    }
}

/// Kind of input at the front of a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InputKind {
    /// A scene, through the geometry processor.
    Scene,
    /// A trace (display list).
    Trace,
}

impl InputKind {
    /// Returns the netlist of the machine behind this kind of input.
    ///
    /// # Errors
    /// Parameters that do not fit together.
    pub fn shape<S: MachineSpec>(self, spec: &S) -> Result<Netlist, ConfigProblem> {
        let shape = match self {
            Self::Scene => empty_machine(spec)?.netlist(),
            Self::Trace => empty_trace_machine(spec)?.netlist(),
        };
        // The wiring was checked when the machine was built.
        shape.map_err(|error| ConfigProblem { key: "wiring".into(), message: error.to_string() })
    }

    /// Returns the statistics of the machine before its first step.
    ///
    /// # Errors
    /// Parameters that do not fit together.
    pub fn facts<S: MachineSpec>(self, spec: &S) -> Result<UnitStats, ConfigProblem> {
        match self {
            Self::Scene => empty_machine(spec).map(|mut machine| machine.facts()),
            Self::Trace => empty_trace_machine(spec).map(|mut machine| machine.facts()),
        }
    }
}

/// Builds the machine behind an empty scene.
///
/// # Errors
/// Parameters that do not fit together.
pub(crate) fn empty_machine<S: MachineSpec>(spec: &S) -> Result<impl PictureMachine + use<S>, ConfigProblem> {
    spec.build(FrontEnd::of_scene(std::iter::empty(), spec.front()))
}

/// Builds the machine behind an empty trace.
fn empty_trace_machine<S: MachineSpec>(spec: &S) -> Result<impl PictureMachine + use<S>, ConfigProblem> {
    spec.build(FrontEnd::of_trace(std::iter::empty(), spec.front()))
}
