//! Resimulation of recordings.

use crate::error::{CommandError, CommandResult, PythonResult, budget, not_a_recording, of_recording};
use crate::run::{RunOutput, analysis_policy, recording_policy};
use crate::watch::RunWatcher;
use basrelief_input::MemoryPool;
use basrelief_sim::{AnalysisPolicy, ResimulateOptions, resimulate_to};
use pyo3::pybacked::PyBackedBytes;
use pyo3::{Python, pyfunction};
use std::io::Read;

/// An open recording.
pub type OpenRecording<'a> = zstd::Decoder<'static, std::io::BufReader<&'a [u8]>>;

/// Opens a recording.
pub fn open_recording(recording: &[u8]) -> CommandResult<OpenRecording<'_>> {
    zstd::Decoder::new(recording).map_err(|_| not_a_recording())
}

/// Computes the timing of a recording anew with these parameters changed. `keep` has two parts: whether bottlenecks are analysed, and
/// whether the recording is kept even if it is long.
#[pyfunction]
pub fn resimulate(
    py: Python<'_>,
    recording: PyBackedBytes,
    settings: Vec<(String, String)>,
    keep: (Option<bool>, bool),
    memory_limit: Option<u64>,
) -> PythonResult<RunOutput<'_>> {
    let (limits, keep) = keep;
    let limits = analysis_policy(limits);
    let kept = if keep { AnalysisPolicy::Always } else { recording_policy(limits) };
    let budget = budget(memory_limit.unwrap_or(MemoryPool::DEFAULT));
    let options = ResimulateOptions { settings, bottlenecks: limits, budget, ..ResimulateOptions::default() };
    let (report, watch) = py.detach(|| resimulate_watched(&mut open_recording(&recording)?, &options, kept))?;
    RunOutput::new(py, (report, watch), true)
}

fn resimulate_watched(
    reader: &mut dyn Read,
    options: &ResimulateOptions,
    kept: AnalysisPolicy,
) -> PythonResult<(String, RunWatcher)> {
    let mut watch = RunWatcher::new(kept, &options.budget).map_err(CommandError::bad_input)?;
    let report = resimulate_to(reader, options, &mut watch);
    if let Some(stopped) = watch.stopped() {
        return Err(stopped.into());
    }
    let report = report.map_err(of_recording)?.report;
    Ok((report.to_json().map_err(CommandError::bad_input)?, watch))
}
