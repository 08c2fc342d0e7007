//! Probes: observers of a run. A probe is a type parameter of the engines, so `NoProbe` costs nothing.

use crate::{Cycle, Label, MemoryEvent, StallCause};
use std::collections::BTreeMap;

/// Observes a run. Stages are numbered in the order of the wiring. Intervals are half-open. Intervals of one stage come in order
/// of time; those of different stages interleave in any order.
pub trait Probe {
    /// Returns true if the probe is called at all. The result is known at compile time if the probe's type is. It is a function
    /// and not a constant, so that a probe can stand behind a pointer.
    fn is_on() -> bool
    where
        Self: Sized,
    {
        true
    }
    /// Returns true if the probe reads labels of steps. Asked after every step.
    fn reads_labels(&self) -> bool {
        false
    }
    /// Returns true if the probe reads FIFO levels and memory events. Asked before the first step.
    fn reads_levels(&self) -> bool {
        true
    }
    /// Reports a step of stage `stage`: `taken` has a bit for each input from which it takes a token, `given` has the labels of
    /// its tokens by output, and `asked` has a bit for each memory client with a request. Calls come in order of execution, ahead
    /// of the times of the step. A token is given before it is taken; otherwise stages interleave in any order. A
    /// [recording](crate::recording) has no tokens, so its resimulation makes no such calls.
    fn on_step(&mut self, stage: usize, [taken, asked]: [u32; 2], given: &[(usize, Label)]) {
        _ = (stage, taken, asked, given);
    }
    /// Reports that a step occupied stage `stage`.
    fn on_busy(&mut self, stage: usize, from: Cycle, to: Cycle);
    /// Reports that stage `stage` waited for `cause`.
    fn on_stall(&mut self, stage: usize, cause: StallCause, from: Cycle, to: Cycle);
    /// Reports that FIFO `fifo`, in the order of the wiring by producer, holds `slots` slots from cycle `at` on (law 10). Called
    /// on change, in order of time, with some delay. Before the first call the FIFO holds none.
    fn on_occupancy(&mut self, fifo: usize, at: Cycle, slots: usize) {
        _ = (fifo, at, slots);
    }
    /// Reports an event of a memory or of one of its clients, with some delay. Events of one [source](MemoryEvent::source) come
    /// in order of time.
    fn on_memory_event(&mut self, event: MemoryEvent) {
        _ = event;
    }
}

/// A probe that observes nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoProbe;

impl Probe for NoProbe {
    fn is_on() -> bool {
        false
    }
    /// Needed because a probe behind a pointer is always on.
    fn reads_levels(&self) -> bool {
        false
    }
    fn on_busy(&mut self, _: usize, _: Cycle, _: Cycle) {}
    fn on_stall(&mut self, _: usize, _: StallCause, _: Cycle, _: Cycle) {}
}

impl<P: Probe + ?Sized> Probe for &mut P {
    fn reads_labels(&self) -> bool {
        (**self).reads_labels()
    }
    fn reads_levels(&self) -> bool {
        (**self).reads_levels()
    }
    fn on_step(&mut self, stage: usize, [taken, asked]: [u32; 2], given: &[(usize, Label)]) {
        (**self).on_step(stage, [taken, asked], given);
    }
    fn on_busy(&mut self, stage: usize, from: Cycle, to: Cycle) {
        (**self).on_busy(stage, from, to);
    }
    fn on_stall(&mut self, stage: usize, cause: StallCause, from: Cycle, to: Cycle) {
        (**self).on_stall(stage, cause, from, to);
    }
    fn on_occupancy(&mut self, fifo: usize, at: Cycle, slots: usize) {
        (**self).on_occupancy(fifo, at, slots);
    }
    fn on_memory_event(&mut self, event: MemoryEvent) {
        (**self).on_memory_event(event);
    }
}

/// One interval of a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interval {
    /// Number of the stage in the wiring.
    pub stage: usize,
    /// The cause of its wait; `None` while a step occupied it.
    pub cause: Option<StallCause>,
    /// First cycle.
    pub from: Cycle,
    /// Cycle after the last.
    pub to: Cycle,
}

/// Records every interval. Adjacent intervals of the same kind are merged.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Recorder {
    /// By stage, in order of time.
    pub stages: Vec<Vec<Interval>>,
    /// By FIFO: number of slots in use from each cycle on.
    pub fifos: Vec<Vec<(Cycle, usize)>>,
    /// Memory events, by source.
    pub memories: BTreeMap<[usize; 4], Vec<MemoryEvent>>,
}

impl Recorder {
    fn add(&mut self, new: Interval) {
        if self.stages.len() <= new.stage {
            self.stages.resize(new.stage + 1, Vec::new());
        }
        let stage = &mut self.stages[new.stage];
        match stage.last_mut() {
            Some(last) if last.cause == new.cause && last.to == new.from => last.to = new.to,
            _ => stage.push(new),
        }
    }
}

impl Probe for Recorder {
    fn on_busy(&mut self, stage: usize, from: Cycle, to: Cycle) {
        self.add(Interval { stage, cause: None, from, to });
    }
    fn on_stall(&mut self, stage: usize, cause: StallCause, from: Cycle, to: Cycle) {
        self.add(Interval { stage, cause: Some(cause), from, to });
    }
    fn on_occupancy(&mut self, fifo: usize, at: Cycle, slots: usize) {
        self.fifos.resize(self.fifos.len().max(fifo + 1), Vec::new());
        self.fifos[fifo].push((at, slots));
    }
    fn on_memory_event(&mut self, event: MemoryEvent) {
        self.memories.entry(event.source()).or_default().push(event);
    }
}
