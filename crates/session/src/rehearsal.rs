//! Runs ahead of the run: they find behind which pictures the user acts, where the user acts at times.
//!
//! What a machine draws must not depend on a cycle (law 6): so the run proper is given counts. Each run ahead is given those that the
//! one before has found, until they stay as they are. A viewpoint's pictures come when they come whatever is done behind them; so each
//! run settles at least one viewpoint more, and there are no more of them than frames. That the counts hold, the run proper checks.

use crate::machines::{Logs as _, MachineSpec};
use crate::observer::Observer;
use crate::outcome::SessionError;
use crate::record::CountedDraws;
use crate::settings::RunOptions;
use basrelief_kernel::{self as kernel, Limits, NoProbe, Outcome};
use basrelief_machines::{Draws as _, SceneFront};
use basrelief_signals::Scene;
use std::rc::Rc;
use std::sync::Arc;

/// The machine with the counts of pictures that its user's times come to; as it is where no user acts at a time.
///
/// # Errors
/// Times without time: the functional model has none.
pub(crate) fn rehearsed<S: MachineSpec>(
    scene: &Arc<Scene>,
    spec: &S,
    settings: &RunOptions,
    observer: &mut dyn Observer,
) -> Result<S, SessionError> {
    let mut told = spec.clone();
    if spec.rehearsed(&[]).is_none() {
        return Ok(told);
    }
    for _ in 0..=scene.frames.len() {
        let Some(shown) = shown(scene, &told, settings, observer)? else { break };
        match told.rehearsed(&shown) {
            Some(next) if next != told => told = next,
            _ => break,
        }
    }
    Ok(told)
}

/// What a run shows: cycles of each picture from the one before, and whether it is the last of its frame; none where the run does not
/// come to its end, which the run proper will then not either.
fn shown<S: MachineSpec>(
    scene: &Arc<Scene>,
    spec: &S,
    settings: &RunOptions,
    observer: &mut dyn Observer,
) -> Result<Option<Vec<(u64, bool)>>, SessionError> {
    let Some(engine) = settings.engine else {
        return Err(SessionError::Fault(
            "the user acts at times, and the functional model has none: choose another engine".into(),
        ));
    };
    // Of the type of the run proper: an engine for another would be compiled beside it, for every machine.
    let mut machine = spec.build(SceneFront::new(CountedDraws::new(scene, &Rc::default()), spec.front()))?;
    let mut pictures = Vec::new();
    let mut take = |machine: &mut S::Machine<SceneFront<CountedDraws>>| {
        let rounds = machine.drain_rounds().into_iter().map(|picture| (picture.index, false));
        let last = machine.drain_finished().into_iter().map(|picture| (picture.index, true));
        pictures.extend(rounds.chain(last));
        observer.progress(0, None)
    };
    let limits = Limits { max_cycles: settings.max_cycles, progress: &mut take };
    #[cfg(feature = "unwatched")]
    let mut probe = NoProbe;
    #[cfg(not(feature = "unwatched"))]
    let mut probe: &mut dyn kernel::Probe = &mut NoProbe;
    let report = kernel::run_with(&mut machine, engine, &mut probe, limits);
    take(&mut machine);
    // By frame, the last picture behind the others.
    pictures.sort();
    let complete = report.outcome == Outcome::Complete;
    Ok(complete.then(|| report.marks.into_iter().zip(pictures.into_iter().map(|(_, last)| last)).collect()))
}
