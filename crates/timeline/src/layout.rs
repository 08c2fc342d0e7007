//! The machine and the part of its run that a time line shows.

use basrelief_kernel::{Diagram, StageTopology, StallCause};

/// A machine as its time lines name it, and the part of a run that they show.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TimelineLayout {
    /// The machine.
    pub machine: String,
    /// Clock \[Hz\]; 0 if unknown.
    pub hz: u64,
    /// Stages, FIFOs, memories and clients of the machine.
    pub diagram: Diagram,
    /// The patent's reference numeral of each stage; empty if it has none.
    pub numerals: Vec<String>,
    /// True for each shown stage.
    pub shown: Vec<bool>,
    /// The first cycle that is shown.
    pub from: u64,
    /// The first one after it that is not.
    pub to: u64,
}

impl TimelineLayout {
    /// All of a machine, in all cycles.
    pub fn new(machine: &str, hz: u64, diagram: Diagram) -> Self {
        let (numerals, shown) = (vec![String::new(); diagram.stages.len()], vec![true; diagram.stages.len()]);
        Self { machine: machine.into(), hz, diagram, numerals, shown, from: 0, to: u64::MAX }
    }

    /// Shows these stages alone, with the FIFOs at their ends and the memories that they use.
    ///
    /// # Errors
    /// The first name that no stage has.
    pub fn show_only<'a>(&mut self, units: &'a [String]) -> Result<(), &'a str> {
        self.shown.fill(false);
        for unit in units {
            let number = self.diagram.stages.iter().position(|stage| stage.name == *unit).ok_or(unit.as_str())?;
            self.shown[number] = true;
        }
        Ok(())
    }

    /// Returns true if a stage is shown.
    pub fn shows(&self, stage: usize) -> bool {
        self.shown.get(stage).is_some_and(|shown| *shown)
    }

    /// Returns true if a memory client is shown, because a stage that uses it is.
    pub fn shows_client(&self, client: usize) -> bool {
        self.diagram.clients.get(client).is_some_and(|client| client.stages.iter().any(|&stage| self.shows(stage)))
    }

    /// Returns true if a memory is shown, because one of its clients is.
    pub fn shows_memory(&self, memory: usize) -> bool {
        let clients = self.diagram.clients.iter().enumerate().filter(|(_, client)| client.memory == memory);
        clients.map(|(number, _)| number).any(|client| self.shows_client(client))
    }

    /// Returns true if a FIFO is shown.
    pub fn shows_fifo(&self, fifo: usize) -> bool {
        self.diagram.fifos.get(fifo).is_some_and(|fifo| fifo.ends.iter().any(|&stage| self.shows(stage)))
    }

    /// A stage's name with its numeral, such as `replacement (110)`.
    pub fn name(&self, stage: usize) -> String {
        let name = &self.diagram.stages[stage].name;
        match self.numerals[stage].as_str() {
            "" => name.clone(),
            numeral => format!("{name} ({numeral})"),
        }
    }
}

/// Cause of a wait, as in the tables of the report, and the FIFO or memory client.
pub(crate) fn wait_cause(stage: &StageTopology, cause: StallCause) -> (&'static str, &str) {
    let (cause, names, number) = match cause {
        StallCause::Starved(number) => ("starved", &stage.inputs, number),
        StallCause::Blocked(number) => ("blocked", &stage.outputs, number),
        StallCause::Memory(number) => ("memory", &stage.clients, number),
    };
    (cause, names.get(number).map_or("", String::as_str))
}

/// Name of a wait: its cause and the FIFO or memory client.
pub(crate) fn wait_name(stage: &StageTopology, cause: StallCause) -> String {
    let (cause, name) = wait_cause(stage, cause);
    format!("{cause}: {name}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples;

    #[test]
    fn a_stage_is_shown_with_its_fifos_and_its_numeral() {
        let mut board = samples::board();
        let last = board.diagram.stages.len() - 1;
        board.numerals[last] = "110".into();
        let name = board.diagram.stages[last].name.clone();
        assert_eq!(board.name(last), format!("{name} (110)"));
        board.show_only(std::slice::from_ref(&name)).unwrap();
        let shown = |board: &TimelineLayout| (0..=last).filter(|&s| board.shows(s)).collect::<Vec<_>>();
        assert_eq!(shown(&board), [last]);
        let fifos = 0..board.diagram.fifos.len();
        assert!(fifos.clone().any(|f| board.shows_fifo(f)) && !fifos.clone().all(|f| board.shows_fifo(f)));
        assert_eq!(board.show_only(&[name, "nobody".into()]), Err("nobody"));
    }
}
