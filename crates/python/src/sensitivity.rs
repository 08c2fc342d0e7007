//! Sensitivity of a run to assumed parameters.

use crate::error::{CommandError, PythonResult};
use crate::host::{PlanFiles, PythonHost};
use crate::scene::RunSource;
use basrelief_dse::{OneAtATimeBase, OpenedInput, Plan, sensitivity};
use basrelief_report::Sensitivity;
use basrelief_sim::RunOptions;
use basrelief_threads as threads;
use std::path::PathBuf;

/// Repeats a run with each assumed parameter changed, one at a time.
pub fn sensitivity_of(source: &RunSource, settings: &RunOptions) -> PythonResult<Sensitivity> {
    let (name, opened) = match source {
        RunSource::Scene(prepared) => (prepared.scene().name.clone(), OpenedInput::Scene(prepared.clone())),
        RunSource::DisplayList(_) => (source.file().unwrap_or("".as_ref()).display().to_string(), OpenedInput::Trace),
    };
    let files = PlanFiles { plan: PathBuf::new(), budget: settings.budget.clone() };
    let host = PythonHost::new(&files);
    let around = OneAtATimeBase::around_run(name, opened, settings);
    let found = Plan::one_at_a_time(around, &host).and_then(|plan| sensitivity(&plan, threads::workers(), &host));
    if let Some(stopped) = host.stopped() {
        return Err(stopped.into());
    }
    Ok(found.map_err(CommandError::bad_input)?)
}
