//! A recording that is resimulated many times.

use super::error::RecordingError;
use super::loaded::{LoadedRecording, config_error};
use super::resimulation::{TimedRun, ensure_complete, netlist_of_same_work};
use crate::build::build_warning;
use basrelief_input::MemoryPool;
use basrelief_machines::{MachineConfig, MachineSpec, for_machine};
use basrelief_parameters::Effect;
use basrelief_report::Report;
use std::io::Read;

/// The recording of a run in memory. Several threads may resimulate it at once, under different parameters.
pub struct Recording {
    loaded: LoadedRecording,
    config: MachineConfig,
}

impl Recording {
    /// Reads a recording to its end.
    ///
    /// # Errors
    /// See [`RecordingError`].
    pub fn read(reader: &mut dyn Read, budget: &MemoryPool) -> Result<Self, RecordingError> {
        let loaded = LoadedRecording::read(reader, budget)?;
        let config = loaded.config(&[])?;
        Ok(Self { loaded, config })
    }

    /// Returns the report of a run under this configuration, byte for byte, but without its bottlenecks.
    ///
    /// # Errors
    /// Parameters under which the machine does other work than was recorded, or does not finish.
    pub fn resimulate(&self, config: &MachineConfig) -> Result<Report, RecordingError> {
        if config.machine().name != self.loaded.machine.name {
            return Err(RecordingError::OtherWork(format!("it was recorded on machine `{}`", self.loaded.machine.name)));
        }
        let mut parameters = self.config.parameters().into_iter().zip(config.parameters());
        let work = parameters.find(|(recorded, other)| recorded.effect == Effect::Work && recorded.default != other.default);
        if let Some((parameter, _)) = work {
            return Err(RecordingError::Work(parameter.key));
        }
        for_machine!(config, spec => self.resimulate_as(spec))
    }

    fn resimulate_as<S: MachineSpec>(&self, spec: &S) -> Result<Report, RecordingError> {
        let LoadedRecording { overrides, input, recording, result, figures, .. } = &self.loaded;
        let recorded: S = overrides.load(&[]).map_err(config_error)?;
        let run = recording.resimulate(netlist_of_same_work(&recorded, spec, *input)?)?;
        ensure_complete(&run)?;
        let mut result = result.clone();
        result.warnings.extend(build_warning(&self.loaded.build));
        TimedRun { spec, input: *input, run: &run }.report(result, figures)
    }
}
