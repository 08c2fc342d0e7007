//! A recording that is resimulated many times.

use super::error::RecordingError;
use super::loaded::{LoadedRecording, recorded_spec};
use super::resimulation::{TimedRun, ensure_complete, netlist_of_same_work};
use crate::build::build_warning;
use basrelief_input::MemoryPool;
use basrelief_machines::{MachineConfig, MachineSpec, for_machine};
use basrelief_parameters::{Effect, Parameter, value_of};
use basrelief_report::Report;
use serde_json::Value;
use std::io::Read;

/// The recording of a run in memory. Several threads may resimulate it at once, under different parameters.
pub struct Recording {
    loaded: LoadedRecording,
    /// Work parameters of the recorded run.
    work: Vec<Parameter>,
}

impl Recording {
    /// Reads a recording to its end.
    ///
    /// # Errors
    /// See [`RecordingError`].
    pub fn read(reader: &mut dyn Read, budget: &MemoryPool) -> Result<Self, RecordingError> {
        let loaded = LoadedRecording::read(reader, budget)?;
        let work = loaded.config.parameters().into_iter().filter(|parameter| parameter.effect == Effect::Work).collect();
        Ok(Self { loaded, work })
    }

    /// Returns the report of a run under this configuration, byte for byte, but without its bottlenecks.
    ///
    /// # Errors
    /// Parameters under which the machine does other work than was recorded, or does not finish.
    pub fn resimulate(&self, config: &MachineConfig) -> Result<Report, RecordingError> {
        let values = config.to_value();
        for_machine!(config, spec => self.resimulate_as(spec, &values))
    }

    fn resimulate_as<S: MachineSpec>(&self, spec: &S, values: &Value) -> Result<Report, RecordingError> {
        let LoadedRecording { config, input, recording, result, figures, build, .. } = &self.loaded;
        let recorded: &S = recorded_spec(config)?;
        // A table of parameters with their provenance for each configuration took a tenth of a sweep.
        if let Some(other) = self.work.iter().find(|recorded| value_of(values, &recorded.key) != Some(&recorded.default)) {
            return Err(RecordingError::Work(other.key.clone()));
        }
        let run = recording.resimulate(netlist_of_same_work(recorded, spec, *input)?)?;
        ensure_complete(&run)?;
        let mut result = result.clone();
        result.warnings.extend(build_warning(build));
        TimedRun { spec, input: *input, run: &run }.report(result, figures)
    }
}
