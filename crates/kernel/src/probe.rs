//! Probes: what every unit did when. A type parameter of the engines, so that `NoProbe` costs nothing.

use crate::{Cause, Cycle, Label, MemoryEvent};
use std::collections::BTreeMap;

/// Watches a run. Stages are numbered in the order of the wiring; intervals are half-open; those of one stage come in
/// order of time, those of different stages interleave as the engine pleases.
pub trait Probe {
    /// Whether to call at all. Known at compile time wherever the probe's type is; a function, so that a probe can stand
    /// behind a pointer, which it could not with a constant.
    fn is_on() -> bool
    where
        Self: Sized,
    {
        true
    }
    /// Whether it is to be told what steps are about; asked after every step.
    fn reads_labels(&self) -> bool {
        false
    }
    /// Whether it is to be told of FIFOs and memories; asked before the first step.
    fn reads_levels(&self) -> bool {
        true
    }
    /// The next step of stage `stage` takes a token of each of these inputs, one bit each, and gives tokens of these labels to these
    /// outputs; `asked` has a bit for each of its memory clients that it asked for something. Told in the order in which the work is done, ahead of how long the step keeps the stage: a token is given before
    /// it is taken; otherwise stages interleave as the engine pleases. Not told of a [tape](crate::tape): it has no tokens.
    fn stepped(&mut self, stage: usize, [taken, asked]: [u32; 2], given: &[(usize, Label)]) {
        _ = (stage, taken, asked, given);
    }
    /// Stage `stage` was kept by a step.
    fn worked(&mut self, stage: usize, from: Cycle, to: Cycle);
    /// Stage `stage` waited for `cause`.
    fn waited(&mut self, stage: usize, cause: Cause, from: Cycle, to: Cycle);
    /// FIFO `fifo`, in the order of the wiring by producer, holds so many slots from cycle `at` on (law 10): told where it
    /// changes, in order of time, some while after. Before the first it holds none.
    fn held(&mut self, fifo: usize, at: Cycle, slots: usize) {
        _ = (fifo, at, slots);
    }
    /// A memory or one of its clients did something: told some while after, what is of one [source](MemoryEvent::source) in order of
    /// time.
    fn memory(&mut self, event: MemoryEvent) {
        _ = event;
    }
}

/// Watches nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoProbe;

impl Probe for NoProbe {
    fn is_on() -> bool {
        false
    }
    /// As it is asked behind a pointer, where it is on.
    fn reads_levels(&self) -> bool {
        false
    }
    fn worked(&mut self, _: usize, _: Cycle, _: Cycle) {}
    fn waited(&mut self, _: usize, _: Cause, _: Cycle, _: Cycle) {}
}

impl<P: Probe + ?Sized> Probe for &mut P {
    fn reads_labels(&self) -> bool {
        (**self).reads_labels()
    }
    fn reads_levels(&self) -> bool {
        (**self).reads_levels()
    }
    fn stepped(&mut self, stage: usize, [taken, asked]: [u32; 2], given: &[(usize, Label)]) {
        (**self).stepped(stage, [taken, asked], given);
    }
    fn worked(&mut self, stage: usize, from: Cycle, to: Cycle) {
        (**self).worked(stage, from, to);
    }
    fn waited(&mut self, stage: usize, cause: Cause, from: Cycle, to: Cycle) {
        (**self).waited(stage, cause, from, to);
    }
    fn held(&mut self, fifo: usize, at: Cycle, slots: usize) {
        (**self).held(fifo, at, slots);
    }
    fn memory(&mut self, event: MemoryEvent) {
        (**self).memory(event);
    }
}

/// One interval of a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interval {
    /// Number of the stage in the wiring.
    pub stage: usize,
    /// Why it waited; `None` while it worked.
    pub cause: Option<Cause>,
    /// First cycle.
    pub from: Cycle,
    /// Cycle after the last.
    pub to: Cycle,
}

/// Keeps every interval, neighbours of the same kind joined.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Recorder {
    /// Per stage, in order of time.
    pub stages: Vec<Vec<Interval>>,
    /// Per FIFO, how many slots it holds from which cycle on.
    pub fifos: Vec<Vec<(Cycle, usize)>>,
    /// What memories did, by source.
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
    fn worked(&mut self, stage: usize, from: Cycle, to: Cycle) {
        self.add(Interval { stage, cause: None, from, to });
    }
    fn waited(&mut self, stage: usize, cause: Cause, from: Cycle, to: Cycle) {
        self.add(Interval { stage, cause: Some(cause), from, to });
    }
    fn held(&mut self, fifo: usize, at: Cycle, slots: usize) {
        self.fifos.resize(self.fifos.len().max(fifo + 1), Vec::new());
        self.fifos[fifo].push((at, slots));
    }
    fn memory(&mut self, event: MemoryEvent) {
        self.memories.entry(event.source()).or_default().push(event);
    }
}
