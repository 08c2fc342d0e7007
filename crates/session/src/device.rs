//! What a run needs to know of a machine, whichever it is.

use crate::exhibit::Exhibit;
use basrelief_deferred_renderer::TileSource;
use basrelief_kernel::RunReport;
use basrelief_machines::texel::FrameLog;
use basrelief_machines::{ConfigProblem, Counts, Draws, FrontConfig, FrontEnd, UnitInfo};
use basrelief_parameters::Parameters;
use basrelief_reference::Style;
use schemars::JsonSchema;
use serde_json::Value;
use std::fmt::Debug;

/// A short cut: its name, and what switches it off.
pub type ShortCut<D> = (&'static str, fn(&mut D));

/// A machine, as its configuration: names it, and builds it behind either way in.
pub trait Device: Parameters + JsonSchema + Clone + Debug + PartialEq + 'static {
    /// As `--machine` names it.
    const NAME: &'static str;
    /// What it is, in a sentence.
    const ABOUT: &'static str;
    /// The patent's block diagram in characters.
    const DIAGRAM: &'static str;
    /// The boxes of the block diagram.
    const UNITS: &'static [UnitInfo];
    /// The demo scenes that are made for it; the first is drawn where none is named.
    const DEMOS: &'static [&'static str];
    /// The short cuts that an ablation switches off.
    const SHORT_CUTS: &'static [ShortCut<Self>] = &[];
    /// The machine behind one way in.
    type Machine<F: FrontEnd>: Exhibits;

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
    /// What its way in needs.
    fn front(&self) -> FrontConfig;
    /// What its pictures are held against.
    fn exact_style(&self) -> Style;
    /// What the reader of a report should know, one sentence each.
    fn warnings(&self, counts: &Counts) -> Vec<String>;
    /// Figures that the machine alone cannot know: of the pictures shown, and of time.
    fn figures(&self, told: &Told<'_>) -> Vec<(&'static str, Value)> {
        let _ = told;
        vec![]
    }
}

/// A picture that was shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// Number of its frame.
    pub frame: u32,
    /// Number within its frame, from 0.
    pub round: u32,
    /// How far it is from the last of its frame \[dB\].
    pub psnr_db: f64,
    /// No better one followed.
    pub last: bool,
}

/// What a run has told beside the counts of the machine.
#[derive(Clone, Copy, Debug)]
pub struct Told<'a> {
    /// What the engine came to; `None` for the functional model.
    pub run: Option<&'a RunReport>,
    /// All pictures, in order.
    pub shown: &'a [Shown],
}

impl Told<'_> {
    /// Cycles from the end of the frame before to each picture.
    pub fn cycles_of_frames(&self, run: &RunReport) -> Vec<u64> {
        let mut since = 0;
        let cycles = self.shown.iter().zip(&run.marks).map(|(shown, cycles)| {
            let own = since + cycles;
            since = if shown.last { 0 } else { own };
            own
        });
        cycles.collect()
    }
}

/// A machine, with what it has to show beside finished pictures: nothing, unless it says so.
pub trait Exhibits: Draws {
    /// Keeps a log of each picture, and what [`Exhibits::drain_exhibits`] shows and is not needed otherwise, from now on, where
    /// the machine has any. Called before the first step.
    fn keep_log(&mut self) {}
    /// Logs of so many pictures, those drained with them, in order; none where none is kept.
    fn drain_logs(&mut self, pictures: usize) -> Vec<FrameLog> {
        let _ = pictures;
        Vec::new()
    }
    /// What there is to show since the last call beside finished pictures, in order; nothing stays in the machine.
    fn drain_exhibits(&mut self) -> Vec<Exhibit> {
        vec![]
    }
    /// What it has lost, in a sentence: it stands still for that, and no fault of its own.
    fn lost(&self) -> Option<String> {
        None
    }
    /// What there is to show when the run is over.
    fn last_exhibits(&mut self) -> Vec<Exhibit> {
        vec![]
    }
}
