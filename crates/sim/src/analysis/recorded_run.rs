//! Runs to compare, with their recordings, and the parameters by which they differ.

use crate::options::RunInput;
use crate::recording::{LoadedRecording, RecordingError, of_build, resimulated_cycles};
use basrelief_input::MemoryPool;
use basrelief_machines::MachineConfig;
use basrelief_report::Report;
use std::io::Read;

/// A run with its recording.
pub struct RecordedRun {
    pub(super) recording: LoadedRecording,
    pub(super) cycles: u64,
}

impl RecordedRun {
    /// Reads the recording of the run with this report.
    ///
    /// # Errors
    /// An invalid recording, the recording of another run, or a recording of another build whose timing this build does not reproduce.
    pub fn read(report: &Report, reader: &mut dyn Read, budget: &MemoryPool) -> Result<Self, RecordingError> {
        let recording = LoadedRecording::read(reader, budget)?;
        let config = &recording.config;
        let cycles = report.frame_cycles();
        let is_of_run = (&recording.result.input, &recording.result.image) == (&report.input, &report.image);
        let is_of_report = config.machine().name == report.machine
            && is_of_run
            && config.to_value() == report.config
            && resimulated_cycles(&recording, config) == Some(cycles);
        match is_of_report {
            true => Ok(Self { recording, cycles }),
            false if is_of_run => Err(of_build(&recording.build, RecordingError::OtherRun)),
            false => Err(RecordingError::OtherRun),
        }
    }

    /// Returns the configuration of the run.
    pub fn config(&self) -> &MachineConfig {
        &self.recording.config
    }
}

/// Resources for the explanation of a difference.
pub struct ExplainOptions<'a> {
    /// Opens the input of both runs for one more run; `None` if the machine must not run.
    pub input: Option<&'a (dyn Fn() -> Option<RunInput> + Sync)>,
    /// Receives the number of measured mixtures, and of all.
    pub progress: &'a (dyn Fn(usize, usize) + Sync),
    /// Memory pool for recordings.
    pub budget: &'a MemoryPool,
}

/// A parameter that the user changed, or several that can only be measured together.
#[derive(Clone, Debug)]
pub(super) struct Cause {
    pub(super) name: String,
    /// Keys with their values in B.
    pub(super) set: Vec<(String, String)>,
    pub(super) is_work: bool,
}
