//! `--sensitivity`: effect of each assumed parameter.

use super::plans::{SweepProgram, sweep_error};
use crate::error::CommandResult;
use crate::global::GlobalOptions;
use crate::input::Input;
use basrelief_dse::{OneAtATimeBase, OpenedInput, Plan, sensitivity};
use basrelief_report::Sensitivity;
use basrelief_sim::RunOptions;
use basrelief_threads as threads;

/// Prepares the analysis of a run.
///
/// # Errors
/// The input can be read only once.
pub fn prepare_analysis(input: &Input, settings: &RunOptions) -> CommandResult<OneAtATimeBase> {
    let (name, opened) = match input {
        Input::Scene(prepared) => (prepared.scene().name.clone(), OpenedInput::Scene(prepared.clone())),
        Input::Trace(trace) => (trace.reopen()?.name, OpenedInput::Trace),
    };
    Ok(OneAtATimeBase::around_run(name, opened, settings))
}

/// Runs the analysis.
///
/// # Errors
/// The input cannot be read any more.
pub fn run_analysis(around: OneAtATimeBase, global: &GlobalOptions, quiet: bool) -> CommandResult<Sensitivity> {
    let host = SweepProgram::around_run(global, quiet);
    let plan = Plan::one_at_a_time(around, &host).map_err(sweep_error)?;
    sensitivity(&plan, threads::workers(), &host).map_err(sweep_error)
}
