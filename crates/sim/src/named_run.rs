//! Runs whose errors name the input.

use crate::command_error::{CommandError, CommandResult};
use crate::observer::{NoObserver, Observer};
use crate::options::{RunInput, RunOptions};
use crate::run::result::RunResult;
use crate::run::run;
use basrelief_input::MemoryPool;
use basrelief_kernel::{Engine, Probe};
use basrelief_machines::MachineConfig;
use basrelief_report::model::OutcomeKind;

/// Runs the machine.
///
/// # Errors
/// An error names the input, unless a parameter or an output is at fault.
pub fn run_named(
    input: RunInput,
    options: &RunOptions,
    observer: &mut dyn Observer,
    probe: Option<&mut dyn Probe>,
) -> CommandResult<RunResult> {
    let name = input.name().to_owned();
    run(input, options, observer, probe).map_err(CommandError::of_run(&name))
}

/// Runs to the end without images, reference image and progress.
///
/// # Errors
/// As [`run_named`], and for a run that does not finish.
pub fn run_quietly(input: RunInput, config: &MachineConfig, engine: Engine, budget: &MemoryPool) -> CommandResult<RunResult> {
    let options = RunOptions {
        config: config.clone(),
        engine: Some(engine),
        exact: false,
        budget: budget.clone(),
        ..RunOptions::default()
    };
    let name = input.name().to_owned();
    let run = run_named(input, &options, &mut NoObserver, None)?;
    match run.report.outcome.kind {
        OutcomeKind::Complete => Ok(run),
        _ => Err(CommandError::in_input(&name)(run.report.outcome.message.as_deref().unwrap_or("incomplete"))),
    }
}
