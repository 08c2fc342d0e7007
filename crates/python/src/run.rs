//! Runs.

use crate::config::Config;
use crate::error::{CommandError, CommandResult, PythonResult, budget};
use crate::outputs::{ChartFiles, OutputArguments, RequestsFile};
use crate::pixels::Pixels;
use crate::scene::{RunSource, RunSubject};
use crate::sensitivity::sensitivity_of;
use crate::watch::RunWatcher;
use basrelief_input::MemoryPool;
use basrelief_kernel::Engine;
use basrelief_sim::{AnalysisPolicy, Observer, RunOptions, run_named};
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
    sensitivity: bool,
    memory_limit: Option<u64>,
    outputs: OutputArguments,
}

impl RunArguments {
    pub fn run_options(&self, config: &Config) -> CommandResult<RunOptions> {
        let engine = match self.engine.as_str() {
            "timed" => Some(Engine::Timed),
            "ticked" => Some(Engine::Ticked),
            "functional" => None,
            other => return Err(CommandError::usage(format_args!("engine: `{other}`; expected timed, ticked or functional"))),
        };
        let limits = analysis_policy(self.bottlenecks);
        if engine.is_none() {
            self.check_untimed()?;
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
            requests: self.outputs.named().any(|(name, _)| name == "requests"),
            budget: budget(self.memory_limit.unwrap_or(MemoryPool::DEFAULT)),
            ..RunOptions::default()
        })
    }
}

impl RunArguments {
    /// Refuses options that need timing.
    fn check_untimed(&self) -> CommandResult {
        let (limited, options) = (self.max_cycles.is_some(), [self.costs, self.recording, self.sensitivity]);
        let options = ["costs", "recording", "sensitivity"].into_iter().zip(options).chain([("max_cycles", limited)]);
        let options = options.filter(|(_, given)| *given).map(|(name, _)| name);
        let given: Vec<&str> = options.chain(self.outputs.named().map(|(name, _)| name)).collect();
        if given.is_empty() {
            return Ok(());
        }
        Err(CommandError::usage(format_args!("engine: functional mode has no timing; remove {}", given.join(", "))))
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
    options.outputs.check(&source)?;
    let (report, watch, has_recording) = py.detach(|| run_watched(&source, &settings, &options))?;
    RunOutput::new(py, (report, watch), has_recording)
}

/// Returns the report, its observer, and whether the recording can be resimulated.
fn run_watched(source: &RunSource, settings: &RunOptions, options: &RunArguments) -> PythonResult<(String, RunWatcher, bool)> {
    let input = source.input()?;
    let mut watch = RunWatcher::new(settings.recording, &settings.budget).map_err(CommandError::bad_input)?;
    let mut charts = options.outputs.charts(&input, settings)?;
    watch.requests = options.outputs.requests(settings)?;
    let observer: &mut dyn Observer = &mut watch;
    let ran = match &mut charts {
        Some(charts) => charts.record(|probe| run_named(input, settings, observer, Some(probe))),
        None => run_named(input, settings, observer, None),
    };
    if let Some(stopped) = watch.stopped() {
        return Err(stopped.into());
    }
    let mut ran = ran?;
    if options.sensitivity && ran.report.outcome.is_complete() {
        ran.report.sensitivity = Some(sensitivity_of(source, settings)?);
    }
    charts.map_or(Ok(()), ChartFiles::publish)?;
    watch.requests.take().map_or(Ok(()), RequestsFile::publish)?;
    // If the analysis was requested but failed, the recording cannot be resimulated either.
    let has_recording =
        ran.recording_is_complete && (settings.recording == AnalysisPolicy::Always || ran.report.bottlenecks.is_some());
    Ok((ran.report.to_json().map_err(CommandError::bad_input)?, watch, has_recording))
}
