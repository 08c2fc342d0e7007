//! What all engines share: limits, recordings, and the states of units between rounds.

use super::step_source::UnitStates;
use crate::machine::Machine;
use crate::recording::{RecordingChunk, RecordingWriter};
use crate::time::{FinalUnitState, MachineTiming};
use crate::{Cycle, MemoryPorts};

/// Limits of a run, and a callback for its progress.
pub struct RunLimits<'a, M> {
    /// No step starts in this cycle or later; the run then ends as [`Outcome::Limit`](crate::Outcome::Limit).
    pub max_cycles: u64,
    /// Called every few rounds, and after each round in which the machine has news, to show progress and to take finished
    /// results. `false` stops the run as [`Outcome::Stopped`](crate::Outcome::Stopped).
    pub progress: &'a mut dyn FnMut(&mut M) -> bool,
}

/// Returns the state of each unit.
pub(super) fn unit_states(machine: &mut impl Machine) -> Vec<FinalUnitState> {
    let mut survey = UnitStates::default();
    machine.wire(&mut survey);
    survey.0
}

/// A recording in progress.
pub(super) struct ActiveRecording<'a> {
    pub(super) writer: &'a mut RecordingWriter,
    pub(super) keep: &'a mut dyn FnMut(RecordingChunk),
}

impl<'a> ActiveRecording<'a> {
    /// Converts it to one with a shorter lifetime. (The compiler does not, because of the pointer to a function in it.)
    pub(super) fn shortened<'b>(self) -> ActiveRecording<'b>
    where
        'a: 'b,
    {
        ActiveRecording { writer: self.writer, keep: self.keep }
    }

    /// Passes on a chunk of the recording, if there is enough for one.
    pub(super) fn keep_chunk(recording: &mut Option<Self>, unit_states: impl FnOnce() -> Vec<FinalUnitState>) {
        if let Some(Self { writer, keep }) = recording
            && writer.is_full()
        {
            keep(writer.finish_chunk(unit_states(), false));
        }
    }
}

/// Between rounds: passes on a finished chunk of the recording and calls `progress` with the machine. The engine owns the
/// memories during a run, so they are swapped in for the call.
pub(super) fn report_progress<M: Machine>(
    machine: &mut M,
    time: &mut MachineTiming,
    recording: &mut Option<ActiveRecording<'_>>,
    progress: &mut dyn FnMut(&mut M) -> bool,
) -> bool {
    ActiveRecording::keep_chunk(recording, || unit_states(machine));
    std::mem::swap(machine.memories(), &mut time.memories);
    let goes_on = progress(machine);
    std::mem::swap(machine.memories(), &mut time.memories);
    goes_on
}

/// Takes a fault and adds the name of its unit and, with timing, the start cycle of its step.
pub(super) fn fault_of(traffic: &mut MemoryPorts, name: &str, start: Option<Cycle>) -> Option<String> {
    let cycle = start.map_or_else(String::new, |start| format!(", {start}"));
    traffic.fault.take().map(|f| format!("{name}{cycle}: {f}"))
}
