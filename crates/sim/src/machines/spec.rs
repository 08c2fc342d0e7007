//! What a run needs to know of a machine, whichever it is.

use crate::costs::CostPoints;
use crate::exhibits::spec::ExhibitSpec;
use crate::methods::MethodSpecs;
use crate::run::{unfed, unfed_trace};
use basrelief_deferred_renderer::{Preview, TileEncoding, TileSource};
use basrelief_frame_buffer::FinishedFrame;
use basrelief_kernel::{Hardware, RunReport};
use basrelief_machines::defer::RunAhead;
use basrelief_machines::{ConfigProblem, Draws, FrontConfig, FrontEnd, UnitInfo, UnitStats, units};
use basrelief_parameters::Parameters;
use basrelief_reference::Style;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt::Debug;

/// A short cut: its name, and what switches it off.
pub type ShortCut<S> = (&'static str, fn(&mut S));

/// A machine, as its configuration: names it, and builds it behind either way in.
pub trait MachineSpec: Parameters + JsonSchema + Clone + Debug + PartialEq + Sync + 'static {
    /// As `--machine` names it.
    const NAME: &'static str;
    /// What it is, in a sentence.
    const ABOUT: &'static str;
    /// The patent's block diagram in characters.
    const DIAGRAM: &'static str;
    /// The demo scenes that are made for it; the first is drawn where none is named.
    const DEMOS: &'static [&'static str];
    /// The short cuts that an ablation switches off.
    const SHORT_CUTS: &'static [ShortCut<Self>] = &[];
    /// What it shows beside its finished pictures.
    const EXHIBITS: &'static [ExhibitSpec<Self, Self::Log>] = &[];
    /// Where its fragments come into being, and where they end.
    const COST_POINTS: CostPoints;
    /// How it can do the same work to the same error.
    const METHODS: Option<MethodSpecs<Self>> = None;
    /// Its textures come over a path, from a server that may be elsewhere.
    const FETCHES_TILES: bool = false;
    /// The parameter that says when views are left for the next, where there is one.
    const LEFT_AT: Option<&'static str> = None;
    /// The stage that takes a tile with each of its steps, where views are left.
    const TAKES_TILES: &'static str = "";
    /// Copies that it and its exact picture make of the texels of each texture.
    const TEXTURE_COPIES: u64 = 0;
    /// The machine behind one way in.
    type Machine<F: FrontEnd>: Logs<Self::Log>;
    /// An entry of its log, of which exhibits are made; `()` where there are none.
    type Log: 'static;

    /// The machine at power-on.
    ///
    /// # Errors
    /// Parameters, each in its range, that do not fit together.
    fn build<F: FrontEnd>(&self, front: F) -> Result<Self::Machine<F>, ConfigProblem>;
    /// The machine behind one way in, with tiles from elsewhere where it fetches any.
    ///
    /// # Errors
    /// As above.
    fn build_remote<F: FrontEnd>(&self, front: F, tiles: Box<dyn TileSource>) -> Result<Self::Machine<F>, ConfigProblem> {
        drop(tiles);
        self.build(front)
    }
    /// The boxes of the block diagram.
    fn units() -> Vec<UnitInfo> {
        let spec = Self::default();
        // What is built as its defaults have it has no problems.
        unfed(&spec)
            .ok()
            .zip(unfed_trace(&spec).ok())
            .map_or(vec![], |(mut scene, mut trace)| units(Self::DIAGRAM, &mut scene, &mut trace))
    }
    /// What it is built of, as it is configured.
    ///
    /// # Errors
    /// Parameters, each in its range, that do not fit together.
    fn hardware(&self) -> Result<Vec<Hardware>, ConfigProblem> {
        Ok(unfed(self)?.facts().all_hardware().to_vec())
    }
    /// How it asks for tiles, where it fetches any.
    fn tile_fetch(&self) -> Option<TileFetch> {
        None
    }
    /// What colours pictures that are still growing, where it fetches tiles.
    fn preview(&self) -> Option<Preview> {
        None
    }
    /// What its way in needs.
    fn front(&self) -> FrontConfig;
    /// What its pictures are held against.
    fn exact_style(&self) -> Style;
    /// What the reader of a report should know, one sentence each.
    fn warnings(&self, facts: &UnitStats) -> Vec<String>;
    /// Tells figures that the machine alone cannot know: of the pictures shown, and of time.
    fn figures(&self, summary: &RunSummary<'_>, facts: &mut UnitStats) {
        let _ = (summary, facts);
    }

    /// Whether the user acts at times: there must be runs ahead of the run, which find where views are left.
    fn acts_at_times(&self) -> bool {
        false
    }
    /// This machine for the first run ahead, of so many views: none is left.
    #[must_use]
    fn never_left(&self, views: usize) -> Self {
        let _ = views;
        self.clone()
    }
    /// This machine, with one view more that is left, by what a run ahead has shown; none where there is no more.
    #[must_use]
    fn left_once_more(&self, ahead: &RunAhead) -> Option<Self> {
        let _ = ahead;
        None
    }

    /// Whether each frame may be shown in several pictures, each better than the one before.
    fn shows_rounds(&self) -> bool {
        false
    }
}

/// How a machine asks for tiles.
#[derive(Clone, Debug, PartialEq)]
pub struct TileFetch {
    /// How tiles are encoded on the path.
    pub encoding: TileEncoding,
    /// Quality of JPEG, where it is that: 1 to 100.
    pub jpeg_quality: u8,
    /// Requests under way at a time.
    pub requests: u32,
    /// Tiles that one of them asks for, at most.
    pub tiles_per_request: u32,
    /// When each view is left for the next \[ms from the start\].
    pub left_at_ms: Vec<f64>,
}

/// A picture that was shown.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PictureRecord {
    /// Number of its frame.
    pub frame: u32,
    /// Number within its frame, from 0.
    pub round: u32,
    /// How far it is from the last of its frame \[dB\].
    pub psnr_db: f64,
    /// No better one followed.
    pub last: bool,
}

/// A run that is over, beside the counts of the machine.
#[derive(Clone, Copy, Debug)]
pub struct RunSummary<'a> {
    /// What the engine came to; `None` for the functional model.
    pub run: Option<&'a RunReport>,
    /// All pictures, in order.
    pub pictures: &'a [PictureRecord],
}

impl RunSummary<'_> {
    /// Cycles from the end of the frame before to each picture.
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

/// A machine that tells more than finished pictures and counts; by itself it tells nothing. `L` is an entry of its log.
pub trait Logs<L>: Draws {
    /// Pictures shown since the last call that a better one follows, in order.
    fn drain_rounds(&mut self) -> Vec<FinishedFrame> {
        vec![]
    }
    /// Keeps a log from now on. Called before the first step, where exhibits are wanted.
    fn keep_log(&mut self) {}
    /// What was logged since the last call, in order, each entry with the number of its frame; `finished` are the frames
    /// finished since then. Nothing that is returned stays in the machine.
    fn drain_log(&mut self, finished: &[FinishedFrame]) -> Vec<(u32, L)> {
        let _ = finished;
        vec![]
    }
    /// What there is to log when the run is over.
    fn last_log(&mut self) -> Option<L> {
        None
    }
    /// What the machine has lost, in a sentence: it stands still for that, and no fault of its own.
    fn lost(&self) -> Option<String> {
        None
    }
}
