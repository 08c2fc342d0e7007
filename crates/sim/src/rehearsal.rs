//! Runs ahead of the run: they find where views are left, where the user acts at times.
//!
//! What a machine draws must not depend on a cycle (law 6): so the run proper is given counts. In the first run ahead no view is left.
//! Each further one is left where the runs before have found: up to the first view that should have been left and was not, it has run
//! as it should, whatever comes behind. So each settles one more view, and the one that finds none is the run proper.

use crate::machines::{Logs as _, MachineSpec};
use crate::observer::Observer;
use crate::outcome::SessionError;
use crate::record::CountedDraws;
use crate::settings::RunOptions;
use basrelief_kernel::stats::FigureValue;
use basrelief_kernel::{self as kernel, Cause, Cycle, Limits, Netlist, Outcome, Probe};
use basrelief_machines::defer::RunAhead;
use basrelief_machines::{Draws as _, SceneFront};
use basrelief_signals::Scene;
use std::rc::Rc;
use std::sync::Arc;

/// The machine that leaves its views where its user's times come to; as it is where no user acts at a time.
///
/// # Errors
/// Times without time: the functional model has none.
pub(crate) fn rehearsed<S: MachineSpec>(
    scene: &Arc<Scene>,
    spec: &S,
    settings: &RunOptions,
    observer: &mut dyn Observer,
) -> Result<S, SessionError> {
    if !spec.acts_at_times() {
        return Ok(spec.clone());
    }
    let mut told = spec.never_left(scene.frames.len());
    while let Some(ahead) = run_ahead(scene, &told, settings, observer)? {
        match told.left_once_more(&ahead) {
            Some(next) => told = next,
            None => break,
        }
    }
    Ok(told)
}

/// What a run shows; none where it does not come to its end, which the run proper will then not either.
fn run_ahead<S: MachineSpec>(
    scene: &Arc<Scene>,
    spec: &S,
    settings: &RunOptions,
    observer: &mut dyn Observer,
) -> Result<Option<RunAhead>, SessionError> {
    let engine = settings.engine.ok_or(SessionError::NoTimes)?;
    // Of the type of the run proper: an engine for another would be compiled beside it, for every machine.
    let mut machine = spec.build(SceneFront::new(CountedDraws::new(scene, &Rc::default()), spec.front()))?;
    let mut pictures = Vec::new();
    let mut take = |machine: &mut S::Machine<SceneFront<CountedDraws>>| {
        let rounds = machine.drain_rounds().into_iter().map(|picture| (picture.index, false));
        let last = machine.drain_finished().into_iter().map(|picture| (picture.index, true));
        pictures.extend(rounds.chain(last));
        observer.progress(0, None)
    };
    let stages = Netlist::of(&mut machine).map(|shape| shape.diagram().stages).unwrap_or_default();
    let taker = stages.iter().position(|stage| stage.name == S::TAKES_TILES);
    let mut came = Came { taker, cycles: Vec::new() };
    let mut probe: &mut dyn Probe = &mut came;
    let limits = Limits { max_cycles: settings.max_cycles, progress: &mut take };
    let report = kernel::run_with(&mut machine, engine, &mut probe, limits);
    take(&mut machine);
    if report.outcome != Outcome::Complete {
        return Ok(None);
    }
    // By frame, the last picture behind the others.
    pictures.sort();
    let pictures = report.marks.into_iter().zip(pictures.into_iter().map(|(_, last)| last)).collect();
    let tiles = match machine.facts().get("view_tiles") {
        Some(FigureValue::Counts(tiles)) => tiles.clone(),
        _ => vec![],
    };
    Ok(Some(RunAhead { pictures, came: came.cycles, tiles }))
}

/// When tiles have come: a step of who takes them each.
struct Came {
    taker: Option<usize>,
    cycles: Vec<u64>,
}

impl Probe for Came {
    fn reads_levels(&self) -> bool {
        false
    }

    fn worked(&mut self, stage: usize, from: Cycle, _: Cycle) {
        if self.taker == Some(stage) {
            self.cycles.push(from.0);
        }
    }

    fn waited(&mut self, _: usize, _: Cause, _: Cycle, _: Cycle) {}
}
