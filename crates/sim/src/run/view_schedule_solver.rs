//! Solver of the view schedule: preliminary runs find the tile count at which the user leaves each view, if the user acts at given times.
//!
//! The work of a machine must not depend on cycles (law 6), so the final run needs counts instead of times. No view is left in the first
//! preliminary run. Each later run leaves the views that the previous runs have determined. A run is correct up to the first view that
//! should have been left and was not. Therefore each run determines one more view, and the schedule of the run that finds no further view
//! is final.

use super::result::RunError;
use crate::observer::Observer;
use crate::options::RunOptions;
use basrelief_geometry_processor::SceneDraws;
use basrelief_kernel::stats::FigureValue;
use basrelief_kernel::{Cycle, Outcome, Probe, RunLimits, StallCause};
use basrelief_machines::defer::RunAhead;
use basrelief_machines::{FrontEnd, LoggingMachine as _, MachineEngines as _, MachineSpec, PictureMachine as _};
use basrelief_signals::Scene;
use std::sync::Arc;

/// Returns the machine with a view schedule in tile counts; a clone if no user acts at given times.
///
/// # Errors
/// The functional model has no time.
pub(crate) fn solve_view_schedule<S: MachineSpec>(
    scene: &Arc<Scene>,
    spec: &S,
    settings: &RunOptions,
    observer: &mut dyn Observer,
) -> Result<S, RunError> {
    if !spec.acts_at_times() {
        return Ok(spec.clone());
    }
    let mut solved = spec.never_left(scene.frames.len());
    while let Some(ahead) = run_ahead(scene, &solved, settings, observer)? {
        match solved.left_once_more(&ahead) {
            Some(next) => solved = next,
            None => break,
        }
    }
    Ok(solved)
}

/// Performs a preliminary run. Returns `None` if it does not finish; the final run will not finish either.
fn run_ahead<S: MachineSpec>(
    scene: &Arc<Scene>,
    spec: &S,
    settings: &RunOptions,
    observer: &mut dyn Observer,
) -> Result<Option<RunAhead>, RunError> {
    let engine = settings.engine.ok_or(RunError::NoTimes)?;
    let mut machine = spec.build(FrontEnd::of_scene(SceneDraws::new(Arc::clone(scene)), spec.front()))?;
    let mut pictures = Vec::new();
    let mut take = |machine: &mut S::Machine| {
        let rounds = machine.drain_rounds().into_iter().map(|picture| (picture.index, false));
        let last = machine.drain_finished().into_iter().map(|picture| (picture.index, true));
        pictures.extend(rounds.chain(last));
        observer.progress(0, None)
    };
    let stages = machine.netlist().map(|shape| shape.diagram().stages).unwrap_or_default();
    let taker = stages.iter().position(|stage| stage.name == S::TAKES_TILES);
    let mut arrivals = TileArrivals { taker, cycles: Vec::new() };
    let limits = RunLimits { max_cycles: settings.max_cycles, progress: &mut take };
    let report = machine.run_with(engine, Some(&mut arrivals), limits);
    take(&mut machine);
    if report.outcome != Outcome::Complete {
        return Ok(None);
    }
    // Sorted by frame, with the last picture of a frame at its end.
    pictures.sort();
    let pictures = report.marks.into_iter().zip(pictures.into_iter().map(|(_, last)| last)).collect();
    let tiles = match machine.facts().get("view_tiles") {
        Some(FigureValue::Counts(tiles)) => tiles.clone(),
        _ => vec![],
    };
    Ok(Some(RunAhead { pictures, came: arrivals.cycles, tiles }))
}

/// Probe for the arrival of tiles: each step of the stage that takes them.
struct TileArrivals {
    taker: Option<usize>,
    cycles: Vec<u64>,
}

impl Probe for TileArrivals {
    fn reads_levels(&self) -> bool {
        false
    }

    fn on_busy(&mut self, stage: usize, from: Cycle, _: Cycle) {
        if self.taker == Some(stage) {
            self.cycles.push(from.0);
        }
    }

    fn on_stall(&mut self, _: usize, _: StallCause, _: Cycle, _: Cycle) {}
}
