//! A tape that is timed again many times.

use super::retime::{complete, report, same_work};
use super::{Loaded, TapeFileError};
use crate::machines::{MachineConfig, MachineSpec, for_machine};
use basrelief_input::Budget;
use basrelief_parameters::Effect;
use basrelief_report::Report;
use std::io::Read;

/// The tape of a run in memory, to be timed again under many parameters, by several threads at once.
pub struct Recording {
    tape: Loaded,
    config: MachineConfig,
}

impl Recording {
    /// Reads a tape to its end.
    ///
    /// # Errors
    /// See [`TapeFileError`].
    pub fn read(reader: &mut dyn Read, budget: &Budget) -> Result<Self, TapeFileError> {
        let tape = Loaded::read(reader, budget)?;
        let config = tape.config()?;
        Ok(Self { tape, config })
    }

    /// The report that a run gives under this configuration, byte for byte, without its limits.
    ///
    /// # Errors
    /// Parameters under which the machine does other work than the tape holds, or does not come to its end.
    pub fn retime(&self, config: &MachineConfig) -> Result<Report, TapeFileError> {
        if config.machine().name != self.tape.machine.name {
            return Err(TapeFileError::OtherWork(format!("it is of machine `{}`", self.tape.machine.name)));
        }
        let differs = self.config.parameters().into_iter().zip(config.parameters());
        let work =
            differs.filter(|(recorded, _)| recorded.effect == Effect::Work).find(|(recorded, p)| recorded.default != p.default);
        if let Some((parameter, _)) = work {
            return Err(TapeFileError::Work(parameter.key));
        }
        for_machine!(config, spec => self.timed_again(spec))
    }

    fn timed_again<S: MachineSpec>(&self, spec: &S) -> Result<Report, TapeFileError> {
        let recorded: S = self.tape.given.load(&[]).map_err(|error| TapeFileError::Config(error.to_string()))?;
        let shape = same_work((&recorded, spec), self.tape.way)?;
        let run = self.tape.tape.resimulate(shape)?;
        complete(&run)?;
        report((spec, self.tape.way), (self.tape.ended.clone(), &self.tape.figures), &run)
    }
}
