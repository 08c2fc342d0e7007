//! What all engines share: limits, recordings, and the states of units between rounds.

use super::work::Survey;
use crate::machine::Machine;
use crate::tape::{Reel, Writer};
use crate::time::{Rest, Time};
use crate::{Cycle, Traffic};

/// Bounds of a run and what to do as it goes.
pub struct Limits<'a, M> {
    /// No step starts in this cycle or later; the run then ends as [`Outcome::Limit`](crate::Outcome::Limit).
    pub max_cycles: u64,
    /// Called every now and then with the machine, and where it has news, to show progress and to take finished results away; `false` stops
    /// the run as [`Outcome::Stopped`](crate::Outcome::Stopped).
    pub progress: &'a mut dyn FnMut(&mut M) -> bool,
}

/// What is left of each unit.
pub(super) fn rests(machine: &mut impl Machine) -> Vec<Rest> {
    let mut survey = Survey::default();
    machine.wire(&mut survey);
    survey.0
}

/// A tape under way.
pub(super) struct Recording<'a> {
    pub(super) writer: &'a mut Writer,
    pub(super) keep: &'a mut dyn FnMut(Reel),
}

/// Between rounds: hands on what is written of a tape, where it is worth a reel, and shows the machine to who looks on, with its
/// memories as they are by now: they are the engine's while it runs.
pub(super) fn look<M: Machine>(
    machine: &mut M,
    time: &mut Time,
    (tape, keep): (&mut Option<&mut Writer>, &mut Option<&mut dyn FnMut(Reel)>),
    progress: &mut dyn FnMut(&mut M) -> bool,
) -> bool {
    if let (Some(writer), Some(keep)) = (tape, keep)
        && writer.is_full()
    {
        keep(writer.reel(rests(machine), false));
    }
    std::mem::swap(machine.memories(), &mut time.memories);
    let goes_on = progress(machine);
    std::mem::swap(machine.memories(), &mut time.memories);
    goes_on
}

/// A fault, prefixed with the unit that raised it and, where there is time, the cycle in which its step started.
pub(super) fn fault_of(traffic: &mut Traffic, name: &str, start: Option<Cycle>) -> Option<String> {
    let cycle = start.map_or_else(String::new, |start| format!(", {start}"));
    traffic.fault.take().map(|f| format!("{name}{cycle}: {f}"))
}
