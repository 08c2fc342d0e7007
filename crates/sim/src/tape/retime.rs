//! Timing a tape again.

use super::pieces::{Pieces, ReelsOfFile};
use super::{End, Given, TapeFileError};
use crate::ended::Ended;
use crate::limits::{Kept, Recorded};
use crate::machines::{MachineConfig, MachineSpec, for_machine};
use crate::observer::{Observer, Unobserved};
use crate::run::Way;
use crate::settings::When;
use basrelief_input::Budget;
use basrelief_kernel::stats::FigureValue as FactValue;
use basrelief_kernel::{self as kernel, Netlist, NoProbe, Outcome, RunReport};
use basrelief_machines::ConfigProblem;
use basrelief_parameters::Effect;
use basrelief_report::Report;
use std::io::Read;

/// How to time a tape again.
#[derive(Clone, Debug)]
pub struct RetimeOptions {
    /// Parameters over those of the run that was recorded, as `--set` takes them.
    pub settings: Vec<(String, String)>,
    /// As in [`RunOptions`](crate::RunOptions::limits).
    pub limits: When,
    /// For what the tape makes it hold.
    pub budget: Budget,
}

/// The report that a run gives with the parameters of the tape and these over them: without model, pictures, or units.
///
/// # Errors
/// See [`TapeFileError`].
pub fn retime(reader: &mut dyn Read, options: &RetimeOptions) -> Result<Report, TapeFileError> {
    retime_to(reader, options, &mut Unobserved)
}

/// The same; the observer is shown the tape of that run.
///
/// # Errors
/// See [`TapeFileError`].
pub fn retime_to(reader: &mut dyn Read, options: &RetimeOptions, observer: &mut dyn Observer) -> Result<Report, TapeFileError> {
    let mut pieces = Pieces { reader, budget: &options.budget };
    let (head, machine) = pieces.begin()?;
    let table = machine.parameters();
    let works = |key: &str| table.iter().any(|p| p.key == key && p.effect == Effect::Work);
    if let Some((key, _)) = options.settings.iter().find(|(key, _)| works(key)) {
        return Err(TapeFileError::Work(key.clone()));
    }
    let recorded = head.given.config(machine, &[])?;
    let mut given = head.given.clone();
    given.settings.extend(options.settings.iter().cloned());
    for_machine!(&given.config(machine, &[])?, spec => timed_again((&recorded, spec, &given), head.way, pieces, (options, observer)))
}

fn timed_again<'a, S: MachineSpec>(
    (recorded, spec, given): (&MachineConfig, &S, &Given),
    way: Way,
    pieces: Pieces<'a>,
    (options, observer): (&RetimeOptions, &'a mut dyn Observer),
) -> Result<Report, TapeFileError> {
    let recorded: S = serde_json::from_value(recorded.to_value()).map_err(|error| TapeFileError::Format(error.to_string()))?;
    let shape = same_work((&recorded, spec), way)?;
    let mut reels = ReelsOfFile::new(pieces, Some(observer), Kept::new(options.limits, &options.budget));
    reels.show(&super::head::<S>(way, given))?;
    let timed = kernel::resimulate(shape, &mut |waiting| reels.next(waiting), &mut NoProbe, u64::MAX);
    // To its end: what is left of the run stands there.
    while timed.is_ok() && reels.next(0).is_ok_and(|reel| reel.is_some()) {}
    let ReelsOfFile { work, kept, end, fault, .. } = reels;
    if let Some(fault) = fault {
        return Err(fault);
    }
    let run = timed?;
    complete(&run)?;
    let Some(End { ended, figures, work: stated }) = end else { return Err(TapeFileError::Format("it has no end".into())) };
    if work.finish() != stated {
        return Err(TapeFileError::Format("its work has another SHA-256 than it says".into()));
    }
    let mut report = report((spec, way), (ended, &figures), &run)?;
    if let Some(reels) = kept.as_ref().and_then(Kept::reels) {
        let recorded = Recorded { spec, given, way, reels, room: options.budget.left(), run: &run, groups: &[] };
        if let Some(measured) = recorded.measure() {
            measured.put(&mut report);
        }
    }
    Ok(report)
}

/// The report of a run that is complete, from what is left of it beside its times.
pub(super) fn report<S: MachineSpec>(
    (spec, way): (&S, Way),
    (ended, figures): (Ended, &[(String, FactValue)]),
    run: &RunReport,
) -> Result<Report, TapeFileError> {
    let mut facts = way.facts(spec).map_err(config)?;
    facts.put(figures);
    Ok(ended.report(spec, facts, Some(run)))
}

/// Whether it came to its end: otherwise pictures and counts would be others.
pub(super) fn complete(run: &RunReport) -> Result<(), TapeFileError> {
    if run.outcome == Outcome::Complete { Ok(()) } else { Err(TapeFileError::Incomplete(outcome_text(&run.outcome))) }
}

pub(crate) fn config(error: ConfigProblem) -> TapeFileError {
    TapeFileError::Config(error.to_string())
}

fn outcome_text(outcome: &Outcome) -> String {
    match outcome {
        Outcome::Deadlock(deadlock) => deadlock.to_string(),
        other => format!("{other:?}"),
    }
}

/// The shape of a machine that does the work of another, behind the same way in: as far as shapes tell, and what its units are built of.
pub(crate) fn same_work<S: MachineSpec>((recorded, spec): (&S, &S), way: Way) -> Result<Netlist, TapeFileError> {
    // Where a user acts at times, what is drawn follows from times.
    if spec.acts_at_times() {
        return Err(TapeFileError::OtherWork("its user acts at times".into()));
    }
    let shape = way.shape(spec).map_err(config)?;
    way.shape(recorded).map_err(config)?.same_work(&shape).map_err(TapeFileError::OtherWork)?;
    let of_units = |spec: &S| way.facts(spec).map(|facts| facts.hardware_of_units().cloned().collect::<Vec<_>>());
    if of_units(recorded).map_err(config)? != of_units(spec).map_err(config)? {
        return Err(TapeFileError::OtherWork("its units are built of other hardware".into()));
    }
    Ok(shape)
}
