//! Run of one point.

use crate::folder::PointFailure;
use crate::plan::{Plan, PlanPoint, run_options};
use crate::{SweepError, SweepHost};
use basrelief_input::MemoryReservation;
use basrelief_reference::RgbPicture;
use basrelief_report::Report;
use basrelief_report::model::OutcomeKind;
use basrelief_sim::{AnalysisPolicy, FramePictures, Observer, RunError, RunOptions, run};

/// Result of the run of a point.
pub(crate) struct PointResult {
    /// Report, or the reason for its absence.
    pub(crate) report: Result<Report, PointFailure>,
    /// The last picture, as a file.
    pub(crate) png: Option<Vec<u8>>,
    /// Recording of a completed run, if requested.
    pub(crate) recording: Option<Vec<u8>>,
}

/// Observer that keeps the last picture, and the recording if memory suffices.
struct PointObserver<'a> {
    host: &'a dyn SweepHost,
    pictures: bool,
    picture: Option<RgbPicture>,
    recording: Option<(Vec<u8>, MemoryReservation)>,
}

impl Observer for PointObserver<'_> {
    fn frame(&mut self, pictures: &FramePictures<'_>) -> Result<(), String> {
        self.picture = self.pictures.then(|| pictures.machine.clone());
        Ok(())
    }

    fn recording(&mut self, bytes: &[u8], _: bool) -> Result<(), String> {
        // Without memory for the recording, the other points run instead.
        self.recording = self.recording.take().and_then(|(mut recording, mut held)| {
            held.try_grow(bytes.len() as u64, "a recording").ok()?;
            recording.extend_from_slice(bytes);
            Some((recording, held))
        });
        Ok(())
    }
}

/// Runs a point.
pub(crate) fn run_point(
    plan: &Plan,
    point: &PlanPoint,
    pictures: bool,
    recording: bool,
    host: &dyn SweepHost,
) -> Result<PointResult, SweepError> {
    let config = match plan.config(&point.places) {
        Ok(config) => config,
        Err(message) => return Ok(PointResult { report: Err(failure("unfit", message)), png: None, recording: None }),
    };
    let input = &plan.inputs[point.input];
    let source = input.opened.input(&input.name, host).map_err(SweepError)?;
    let options = RunOptions {
        recording: if recording { AnalysisPolicy::Always } else { AnalysisPolicy::Never },
        overrides: plan.overrides_of(&point.places),
        exact: plan.exact,
        ..run_options(config, plan.max_cycles, host)
    };
    let mut watch = PointObserver {
        host,
        pictures,
        picture: None,
        recording: recording.then(|| (vec![], host.budget().empty_reservation())),
    };
    let ran = run(source, &options, &mut watch, None);
    let PointObserver { host, picture, recording, .. } = watch;
    let png = picture.map(|picture| host.png(&picture)).transpose().map_err(SweepError)?;
    Ok(match ran {
        Ok(run) if run.report.outcome.is_complete() => {
            let recording = recording.filter(|_| run.recording_is_complete).map(|(recording, _)| recording);
            PointResult { report: Ok(run.report), png, recording }
        }
        Ok(run) => PointResult { report: Err(incomplete(&run.report)), png: None, recording: None },
        Err(error) => PointResult { report: Err(of_error(&error)), png: None, recording: None },
    })
}

fn failure(outcome: &str, message: String) -> PointFailure {
    PointFailure { outcome: outcome.into(), message }
}

fn incomplete(report: &Report) -> PointFailure {
    let message = report.outcome.message.clone().unwrap_or_default();
    match report.outcome.kind {
        OutcomeKind::Deadlock => failure("deadlock", message),
        OutcomeKind::Limit => failure("limit", "stopped at the limit of max_cycles".into()),
        OutcomeKind::Complete | OutcomeKind::Stopped | OutcomeKind::Fault => failure("fault", message),
    }
}

fn of_error(error: &RunError) -> PointFailure {
    let outcome = match error {
        RunError::Config(_) => "unfit",
        RunError::Fault(_) => "fault",
        _ => "error",
    };
    failure(outcome, error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_sim::{NoObserver, RunInput, doc_trace};

    #[test]
    fn incomplete_run_has_outcome_and_message() {
        let source = RunInput::trace(std::io::Cursor::new(doc_trace()), "quad.dl.jsonl");
        let mut report = run(source, &RunOptions::default(), &mut NoObserver, None).unwrap().report;
        let mut ended = |kind, message: Option<&str>| {
            (report.outcome.kind, report.outcome.message) = (kind, message.map(str::to_owned));
            incomplete(&report)
        };
        assert_eq!(ended(OutcomeKind::Deadlock, Some("a waits for b")), failure("deadlock", "a waits for b".into()));
        assert_eq!(ended(OutcomeKind::Limit, None), failure("limit", "stopped at the limit of max_cycles".into()));
        assert_eq!(ended(OutcomeKind::Fault, Some("no more")), failure("fault", "no more".into()));
        assert_eq!(of_error(&RunError::Fault("no more".into())), failure("fault", "no more".into()));
    }
}
