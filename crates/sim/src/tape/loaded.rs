//! A whole tape in memory.

use super::pieces::{Pieces, ReelsOfFile};
use super::{End, Given, TapeFileError};
use crate::ended::Ended;
use crate::machines::{MachineConfig, MachineInfo, for_machine};
use crate::run::Way;
use basrelief_input::{Budget, Held};
use basrelief_kernel::Recording;
use basrelief_kernel::stats::FigureValue as FactValue;
use std::io::Read;

/// A whole tape in memory.
pub(crate) struct Loaded {
    pub(super) machine: &'static MachineInfo,
    pub(crate) given: Given,
    pub(crate) way: Way,
    pub(crate) tape: Recording<'static>,
    /// What is left of the run beside its times.
    pub(crate) ended: Ended,
    /// What the units counted.
    pub(super) figures: Vec<(String, FactValue)>,
    /// SHA-256 of the work.
    pub(crate) work: String,
    _held: Held,
}

impl Loaded {
    /// Reads it, to its end.
    pub(crate) fn read(reader: &mut dyn Read, budget: &Budget) -> Result<Self, TapeFileError> {
        let mut pieces = Pieces { reader, budget };
        let (head, machine) = pieces.begin()?;
        let mut reels = ReelsOfFile::new(pieces, None, None);
        let mut all = Vec::new();
        while let Some(reel) = reels.read()? {
            all.push(reel);
        }
        match reels.end {
            Some(End { ended, figures, work }) if work == reels.work.finish() => {
                let (given, way) = (head.given, head.way);
                let shape = for_machine!(&given.config(machine, &[])?, spec => way.shape(spec));
                let shape = shape.map_err(|problem| TapeFileError::Format(problem.to_string()))?;
                let tape = Recording::new(all, &shape, budget.left());
                Ok(Self { machine, given, way, tape, ended, figures, work, _held: reels.waiting })
            }
            _ => Err(TapeFileError::Format("its work has another SHA-256 than it says".into())),
        }
    }

    pub(crate) fn config(&self) -> Result<MachineConfig, TapeFileError> {
        self.config_with(&[])
    }

    /// The configuration of the run, with these settings over it.
    pub(crate) fn config_with(&self, settings: &[(String, String)]) -> Result<MachineConfig, TapeFileError> {
        self.given.config(self.machine, settings)
    }
}
