//! What a run needs to know of a machine, whichever it is.

use basrelief_frame_buffer::FinishedFrame;
use basrelief_kernel::Machine;
use basrelief_machines::texel::FrameLog;
use basrelief_machines::{ConfigProblem, Counts, FrontConfig, FrontEnd, UnitInfo};
use basrelief_parameters::Parameters;
use basrelief_reference::Style;
use schemars::JsonSchema;
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
    type Machine<F: FrontEnd>: Draws;

    /// The machine at power-on.
    ///
    /// # Errors
    /// Parameters, each in its range, that do not fit together.
    fn build<F: FrontEnd>(&self, front: F) -> Result<Self::Machine<F>, ConfigProblem>;
    /// What its way in needs.
    fn front(&self) -> FrontConfig;
    /// What its pictures are held against.
    fn exact_style(&self) -> Style;
    /// What the reader of a report should know, one sentence each.
    fn warnings(&self, counts: &Counts) -> Vec<String>;
}

/// A machine that finishes pictures.
pub trait Draws: Machine {
    /// What its units counted, in the order of the block diagram.
    fn counts(&self) -> Counts;
    /// Pictures finished since the last call, in order.
    fn drain_finished(&mut self) -> Vec<FinishedFrame>;
    /// Whether [`Draws::drain_finished`] would give any.
    fn has_finished(&self) -> bool;
    /// Keeps a log of each picture from now on, where the machine has one. Called before the first step.
    fn keep_log(&mut self) {}
    /// Logs of so many pictures, those drained with them, in order; none where none is kept.
    fn drain_logs(&mut self, pictures: usize) -> Vec<FrameLog> {
        let _ = pictures;
        Vec::new()
    }
}
