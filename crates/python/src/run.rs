//! A run.

use crate::config::Config;
use crate::error::{Done, bad, budget, of_run, usage};
use crate::pixels::Pixels;
use crate::scene::{Drawn, Source};
use crate::watch::Watch;
use basrelief_input::Budget;
use basrelief_kernel::Engine;
use basrelief_sim::{AnalysisPolicy, RunOptions, run as sim_run};
use pyo3::types::PyBytes;
use pyo3::{Bound, FromPyObject, IntoPyObject, PyResult, Python, pyfunction};

/// How to run: the options of the command line.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Options {
    /// `timed`, `ticked`, or `functional`, which has no time.
    engine: String,
    max_cycles: Option<u64>,
    exact: bool,
    /// What limits the run is measured; where nothing is said, if it is short.
    limits: Option<bool>,
    costs: bool,
    /// The tape is kept however long it is.
    tape: bool,
    memory_limit: Option<u64>,
}

impl Options {
    fn run_options(&self, config: &Config) -> Done<RunOptions> {
        let engine = match self.engine.as_str() {
            "timed" => Some(Engine::Timed),
            "ticked" => Some(Engine::Ticked),
            "functional" => None,
            other => return Err(usage(format_args!("engine: `{other}`; expected timed, ticked or functional"))),
        };
        let limits = when(self.limits);
        if engine.is_none() && (self.costs || self.tape || self.max_cycles.is_some()) {
            return Err(usage("engine: the functional model has no time: leave out costs, tape and max_cycles"));
        }
        if self.max_cycles == Some(0) {
            return Err(usage("max_cycles: 0; expected 1 or more"));
        }
        Ok(RunOptions {
            config: config.config.clone(),
            overrides: config.given.clone(),
            engine,
            max_cycles: self.max_cycles.unwrap_or(u64::MAX),
            exact: self.exact,
            bottlenecks: limits,
            recording: if self.tape { AnalysisPolicy::Always } else { limits_tape(limits) },
            costs: self.costs,
            budget: budget(self.memory_limit.unwrap_or(Budget::DEFAULT)),
            ..RunOptions::default()
        })
    }
}

/// For which runs limits are measured.
pub fn when(limits: Option<bool>) -> AnalysisPolicy {
    match limits {
        None => AnalysisPolicy::IfShort,
        Some(true) => AnalysisPolicy::Always,
        Some(false) => AnalysisPolicy::Never,
    }
}

/// Which tapes are kept where nobody asks for one.
pub fn limits_tape(limits: AnalysisPolicy) -> AnalysisPolicy {
    if limits == AnalysisPolicy::Never { AnalysisPolicy::Never } else { AnalysisPolicy::IfShort }
}

/// What a run comes to.
#[derive(IntoPyObject)]
pub struct Ran<'py> {
    /// JSON.
    report: String,
    /// The machine's picture of the last frame, and the exact one.
    image: Option<Pixels<'py>>,
    reference: Option<Pixels<'py>>,
    /// Compressed.
    tape: Option<Bound<'py, PyBytes>>,
}

impl<'py> Ran<'py> {
    pub fn new(py: Python<'py>, (report, mut watch): (String, Watch), has_tape: bool) -> PyResult<Self> {
        let (image, reference) = watch.last.take().map_or((None, None), |(image, reference)| (Some(image), reference));
        let tape = watch.into_tape().map_err(bad)?.filter(|_| has_tape);
        Ok(Self {
            report,
            image: image.map(|picture| Pixels::of(py, &picture)),
            reference: reference.map(|picture| Pixels::of(py, &picture)),
            tape: tape.map(|bytes| PyBytes::new(py, &bytes)),
        })
    }
}

/// Runs a machine.
#[pyfunction]
pub fn run<'py>(py: Python<'py>, config: &Bound<'py, Config>, drawn: Drawn<'py>, options: Options) -> PyResult<Ran<'py>> {
    let (source, settings) = (drawn.source(), options.run_options(config.get())?);
    let (report, watch, has_tape) = py.detach(|| watched(source, &settings))?;
    Ran::new(py, (report, watch), has_tape)
}

/// The report, who has watched, and whether the tape is worth anything.
fn watched(source: Source, settings: &RunOptions) -> PyResult<(String, Watch, bool)> {
    let input = source.into_input()?;
    let name = input.name().to_owned();
    let mut watch = Watch::new(settings.recording, &settings.budget).map_err(bad)?;
    let ran = sim_run(input, settings, &mut watch, None);
    if let Some(stopped) = watch.stopped() {
        return Err(stopped);
    }
    let ran = ran.map_err(of_run(&name))?;
    // Where limits could not be measured, it cannot be timed again either; unless they were not to be.
    let has_tape = ran.recording_is_complete && (settings.recording == AnalysisPolicy::Always || ran.report.limits.is_some());
    Ok((ran.report.to_json().map_err(bad)?, watch, has_tape))
}
