//! Analyses of several runs, FIFO sizing, figures of a report, and recorded traces.

use crate::config::Config;
use crate::error::{CommandError, CommandResult, PythonResult, budget, of_recording};
use crate::recording::open_recording;
use crate::run::RunArguments;
use crate::scene::{RunSource, RunSubject};
use crate::watch::RunWatcher;
use basrelief_dse::Cell;
use basrelief_dse::figures::figure_of;
use basrelief_input::MemoryPool;
use basrelief_outputs::PartialFile;
use basrelief_sim::{
    AnalysisPolicy, Observer, RecordingError, RunOptions, RunResult, TraceOptions, ablate as sim_ablate,
    compare_methods as sim_compare_methods, record_trace, run_named, size_fifos as sim_size_fifos,
};
use basrelief_trace::TraceForm;
use pyo3::pybacked::PyBackedBytes;
use pyo3::{Bound, IntoPyObject, Python, pyfunction};
use serde::Serialize;
use std::io::{Read, Write};
use std::path::PathBuf;

/// Runs the input with each shortcut of the machine switched off in turn. Returns the JSON of the command line.
#[pyfunction]
pub fn ablate<'py>(
    py: Python<'py>,
    config: &Bound<'py, Config>,
    drawn: RunSubject<'py>,
    options: RunArguments,
) -> PythonResult<String> {
    json_of_runs(py, config, &drawn.source(), options, |settings, watch, run| sim_ablate(settings, watch, run))
}

/// Runs the input with each division method of the machine at the same error. Returns the JSON of the command line.
#[pyfunction]
pub fn compare_methods<'py>(
    py: Python<'py>,
    config: &Bound<'py, Config>,
    drawn: RunSubject<'py>,
    options: RunArguments,
) -> PythonResult<String> {
    json_of_runs(py, config, &drawn.source(), options, |settings, watch, run| sim_compare_methods(settings, watch, run))
}

/// Runs with the given options and observer.
type RunOnce<'a> = &'a mut dyn FnMut(&RunOptions, &mut dyn Observer) -> CommandResult<RunResult>;

fn json_of_runs<T: Serialize>(
    py: Python<'_>,
    config: &Bound<'_, Config>,
    source: &RunSource,
    options: RunArguments,
    table: impl FnOnce(&RunOptions, &mut dyn Observer, RunOnce<'_>) -> CommandResult<T> + Send,
) -> PythonResult<String> {
    let settings = options.run_options(config.get())?;
    py.detach(|| {
        let mut watch = RunWatcher::new(AnalysisPolicy::Never, &settings.budget).map_err(CommandError::bad_input)?;
        let mut run = |settings: &RunOptions, observer: &mut dyn Observer| run_named(source.input()?, settings, observer, None);
        let table = table(&settings, &mut watch, &mut run);
        if let Some(stopped) = watch.stopped() {
            return Err(stopped.into());
        }
        Ok(serde_json::to_string(&table?).map_err(CommandError::bad_input)?)
    })
}

/// Finds the smallest FIFO depths that keep the cycles of all recordings within these percentages. Returns the JSON of the command line.
#[pyfunction]
pub fn size_fifos(
    py: Python<'_>,
    recordings: Vec<PyBackedBytes>,
    within: Vec<f64>,
    memory_limit: Option<u64>,
) -> PythonResult<String> {
    py.detach(|| {
        let mut opened = recordings.iter().map(|recording| open_recording(recording)).collect::<CommandResult<Vec<_>>>()?;
        let readers = opened.iter_mut().map(|recording| recording as &mut dyn Read).collect();
        let sizes = sim_size_fifos(readers, &within, &budget(memory_limit.unwrap_or(MemoryPool::DEFAULT)));
        let sizes = sizes.map_err(|error| match error {
            RecordingError::Different { number, .. } => CommandError::in_input(&format!("recording {}", number + 1))(error),
            RecordingError::OneOf { error, .. } => of_recording(*error),
            error => of_recording(error),
        })?;
        Ok(serde_json::to_string(&sizes).map_err(CommandError::bad_input)?)
    })
}

/// Writes the trace of a scene. Returns the number of its commands.
#[pyfunction]
pub fn record<'py>(
    py: Python<'py>,
    config: &Bound<'py, Config>,
    drawn: RunSubject<'py>,
    path: PathBuf,
    expect: bool,
    memory_limit: Option<u64>,
) -> PythonResult<u64> {
    let (source, config) = (drawn.source(), config.get());
    py.detach(|| {
        let RunSource::Scene(scene) = &source else {
            return Err(CommandError::usage("record: the input is already a trace; expected a scene").into());
        };
        let name = path.display().to_string();
        let form = TraceForm::for_file_name(&name).ok_or_else(|| {
            CommandError::Usage(format!(
                "{name}: the file name selects the form of a trace; expected .jsonl or .bdl, or either with .zst appended"
            ))
        })?;
        let budget = budget(memory_limit.unwrap_or(MemoryPool::DEFAULT));
        let expect = expect.then_some(&*config.given.settings);
        let options = TraceOptions { config: &config.config, form, expect, budget: &budget };
        let failed = CommandError::at_file(&path, "be written");
        let mut file = PartialFile::create(&path).map_err(&failed)?;
        let commands = record_trace(scene.scene(), &mut file, &options, &mut |_| {})?;
        file.flush().and_then(|()| file.publish()).map_err(failed)?;
        Ok(commands)
    })
}

/// Value of a figure.
#[derive(IntoPyObject)]
pub enum FigureNumber {
    Whole(u64),
    Real(f64),
}

/// Returns the figure of a report by the name that plans use.
#[pyfunction]
pub fn figure(report: &str, name: &str) -> PythonResult<FigureNumber> {
    let report = serde_json::from_str(report).map_err(CommandError::bad_input)?;
    match figure_of(&report, name).map_err(CommandError::Usage)? {
        Cell::Whole(whole) => Ok(FigureNumber::Whole(whole)),
        Cell::Number(real) => Ok(FigureNumber::Real(real)),
        other => Err(CommandError::Usage(format!("`{name}` is {other}, not a number")).into()),
    }
}
