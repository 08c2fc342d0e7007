//! A whole recording in memory.

use super::error::RecordingError;
use super::reader::{BlockReader, ChunkReader, checked_end};
use super::shared::SharedRecording;
use crate::build::BUILD;
use crate::options::Overrides;
use crate::run::untimed::UntimedResult;
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_kernel::stats::FigureValue;
use basrelief_machines::{InputKind, MachineConfig, MachineInfo, MachineSpec, for_machine};
use std::io::Read;

/// A whole recording in memory.
pub(crate) struct LoadedRecording {
    /// Build of the simulator that executed the steps.
    pub(crate) build: String,
    machine: &'static MachineInfo,
    pub(crate) overrides: Overrides,
    /// Configuration of the recorded run.
    pub(crate) config: MachineConfig,
    pub(crate) input: InputKind,
    pub(crate) recording: SharedRecording<'static>,
    pub(crate) result: UntimedResult,
    /// Statistics of the units.
    pub(super) figures: Vec<(String, FigureValue)>,
    /// SHA-256 of the work.
    pub(crate) work: String,
    _held: MemoryReservation,
}

impl LoadedRecording {
    /// Reads a recording to its end.
    pub(crate) fn read(reader: &mut dyn Read, budget: &MemoryPool) -> Result<Self, RecordingError> {
        let mut blocks = BlockReader::new(reader, budget);
        let (header, machine) = blocks.header()?;
        let mut chunks = ChunkReader::new(blocks, None, None);
        let mut all = Vec::new();
        while let Some(chunk) = chunks.read()? {
            all.push(chunk);
        }
        let end = checked_end(chunks.end, chunks.work)?;
        let (build, overrides, input) = (header.build, header.overrides, header.input);
        let config = overrides.config(machine, &[]).map_err(|error| of_build(&build, config_error(error)))?;
        let netlist = for_machine!(&config, spec => input.shape(spec));
        let netlist = netlist.map_err(|problem| of_build(&build, RecordingError::Format(problem.to_string())))?;
        let recording = SharedRecording::new(all, &netlist, budget.left());
        let (result, figures, work) = (end.result, end.figures, end.work);
        Ok(Self { build, machine, overrides, config, input, recording, result, figures, work, _held: chunks.waiting })
    }

    /// Returns the configuration of the recorded run with `more` settings.
    pub(crate) fn config_with(&self, more: &[(String, String)]) -> Result<MachineConfig, RecordingError> {
        self.overrides.config(self.machine, more).map_err(config_error)
    }
}

/// Returns the configuration of a recorded run.
///
/// # Errors
/// A run of another machine.
pub(super) fn recorded_spec<S: MachineSpec>(recorded: &MachineConfig) -> Result<&S, RecordingError> {
    let other = || RecordingError::OtherWork(format!("it was recorded on machine `{}`", recorded.machine().name));
    recorded.spec().ok_or_else(other)
}

/// Converts an error in a recording that this build of the simulator made.
pub(crate) fn of_build(build: &str, error: RecordingError) -> RecordingError {
    if build == BUILD { error } else { RecordingError::OtherBuild { build: build.into(), reason: error.to_string() } }
}

/// Converts an error in the parameters.
pub(crate) fn config_error(error: impl std::fmt::Display) -> RecordingError {
    RecordingError::Config(error.to_string())
}
