//! Runs.

use crate::config::Config;
use crate::error::{CommandError, CommandResult, PythonResult, budget};
use crate::pixels::Pixels;
use crate::scene::{RunSource, RunSubject};
use crate::watch::RunWatcher;
use basrelief_input::MemoryPool;
use basrelief_kernel::Engine;
use basrelief_sim::{AnalysisPolicy, RunOptions, run as sim_run};
use pyo3::types::PyBytes;
use pyo3::{Bound, FromPyObject, IntoPyObject, Python, pyfunction};

/// The options of a run, as on the command line.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct RunArguments {
    /// `timed`, `ticked`, or `functional` (without timing).
    engine: String,
    max_cycles: Option<u64>,
    exact: bool,
    /// Analyse bottlenecks; `None` means only if the recording is short.
    bottlenecks: Option<bool>,
    costs: bool,
    /// Keep the recording even if it is long.
    recording: bool,
    memory_limit: Option<u64>,
}

impl RunArguments {
    fn run_options(&self, config: &Config) -> CommandResult<RunOptions> {
        let engine = match self.engine.as_str() {
            "timed" => Some(Engine::Timed),
            "ticked" => Some(Engine::Ticked),
            "functional" => None,
            other => return Err(CommandError::usage(format_args!("engine: `{other}`; expected timed, ticked or functional"))),
        };
        let limits = analysis_policy(self.bottlenecks);
        if engine.is_none() && (self.costs || self.recording || self.max_cycles.is_some()) {
            return Err(CommandError::usage("engine: functional mode has no timing; remove costs, recording and max_cycles"));
        }
        if self.max_cycles == Some(0) {
            return Err(CommandError::usage("max_cycles: 0; expected 1 or more"));
        }
        Ok(RunOptions {
            config: config.config.clone(),
            overrides: config.given.clone(),
            engine,
            max_cycles: self.max_cycles.unwrap_or(u64::MAX),
            exact: self.exact,
            bottlenecks: limits,
            recording: if self.recording { AnalysisPolicy::Always } else { recording_policy(limits) },
            costs: self.costs,
            budget: budget(self.memory_limit.unwrap_or(MemoryPool::DEFAULT)),
            ..RunOptions::default()
        })
    }
}

/// Returns the policy of the bottleneck analysis.
pub fn analysis_policy(limits: Option<bool>) -> AnalysisPolicy {
    match limits {
        None => AnalysisPolicy::IfShort,
        Some(true) => AnalysisPolicy::Always,
        Some(false) => AnalysisPolicy::Never,
    }
}

/// Returns which recordings are kept by default.
pub fn recording_policy(limits: AnalysisPolicy) -> AnalysisPolicy {
    if limits == AnalysisPolicy::Never { AnalysisPolicy::Never } else { AnalysisPolicy::IfShort }
}

/// Result of a run.
#[derive(IntoPyObject)]
pub struct RunOutput<'py> {
    /// JSON.
    report: String,
    /// Image and reference image of the last frame.
    image: Option<Pixels<'py>>,
    reference: Option<Pixels<'py>>,
    /// Compressed with zstd.
    recording: Option<Bound<'py, PyBytes>>,
}

impl<'py> RunOutput<'py> {
    pub fn new(py: Python<'py>, (report, mut watch): (String, RunWatcher), has_recording: bool) -> PythonResult<Self> {
        let (image, reference) = watch.last.take().map_or((None, None), |(image, reference)| (Some(image), reference));
        let recording = watch.into_recording().map_err(CommandError::bad_input)?.filter(|_| has_recording);
        Ok(Self {
            report,
            image: image.map(|picture| Pixels::of(py, &picture)),
            reference: reference.map(|picture| Pixels::of(py, &picture)),
            recording: recording.map(|bytes| PyBytes::new(py, &bytes)),
        })
    }
}

/// Runs a machine.
#[pyfunction]
pub fn run<'py>(
    py: Python<'py>,
    config: &Bound<'py, Config>,
    drawn: RunSubject<'py>,
    options: RunArguments,
) -> PythonResult<RunOutput<'py>> {
    let (source, settings) = (drawn.source(), options.run_options(config.get())?);
    let (report, watch, has_recording) = py.detach(|| run_watched(source, &settings))?;
    RunOutput::new(py, (report, watch), has_recording)
}

/// Returns the report, its observer, and whether the recording can be resimulated.
fn run_watched(source: RunSource, settings: &RunOptions) -> PythonResult<(String, RunWatcher, bool)> {
    let input = source.into_input()?;
    let name = input.name().to_owned();
    let mut watch = RunWatcher::new(settings.recording, &settings.budget).map_err(CommandError::bad_input)?;
    let ran = sim_run(input, settings, &mut watch, None);
    if let Some(stopped) = watch.stopped() {
        return Err(stopped.into());
    }
    let ran = ran.map_err(CommandError::of_run(&name))?;
    // If the analysis was requested but failed, the recording cannot be resimulated either.
    let has_recording =
        ran.recording_is_complete && (settings.recording == AnalysisPolicy::Always || ran.report.bottlenecks.is_some());
    Ok((ran.report.to_json().map_err(CommandError::bad_input)?, watch, has_recording))
}
