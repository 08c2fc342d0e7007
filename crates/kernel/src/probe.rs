//! Probes: observers of a run. The timed engine is compiled a second time without any, so that such runs pay nothing.

use crate::{Cycle, Label, MemoryEvent, Request, StallCause};
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
    /// Returns true if the probe, which reads levels, also reads numbers of visible tokens. Asked before the first step.
    fn reads_visible(&self) -> bool {
        true
    }
    /// Reports a step of stage `stage`: `taken` has a bit for each input from which it takes a token, `given` has the labels of
    /// its tokens by output, and `asked` has a bit for each memory client with a request. Calls come in order of execution, ahead
    /// of the times of the step. A token is given before it is taken; otherwise stages interleave in any order. A
    /// [recording](crate::recording) has no tokens, so its resimulation makes no such calls.
    fn on_step(&mut self, stage: usize, [taken, asked]: [u32; 2], given: &[(usize, Label)]) {
        _ = (stage, taken, asked, given);
    }
    /// Returns true if the probe reads wires: bits of tokens, the cycles in which they become visible, and answers. Asked before
    /// the first step.
    fn reads_wires(&self) -> bool {
        false
    }
    /// Reports the wires of a step. Calls come in order of execution, as for [`Probe::on_step`].
    fn on_wires(&mut self, stage: usize, step: &StepWires<'_>) {
        _ = (stage, step);
    }
    /// Reports that the next token of FIFO `fifo` becomes visible in cycle `at`. Calls come in order of tokens, with some delay.
    fn on_visible(&mut self, fifo: usize, at: Cycle) {
        _ = (fifo, at);
    }
    /// Reports the last answer of each memory client that step `step` of stage `stage` awaited, 0 for none. Both are counted
    /// from 0. Calls come with some delay, once or twice for a step.
    fn on_answers(&mut self, stage: usize, step: u64, answers: &[Cycle]) {
        _ = (stage, step, answers);
    }
    /// Reports the unit of a stage after the run.
    fn on_unit(&mut self, stage: usize, unit: &UnitWires) {
        _ = (stage, unit);
    }
    /// Reports that a step occupied stage `stage`.
    fn on_busy(&mut self, stage: usize, from: Cycle, to: Cycle);
    /// Reports that stage `stage` waited for `cause`. Waits after its last step are reported at the end of the run. They end with the
    /// run.
    fn on_stall(&mut self, stage: usize, cause: StallCause, from: Cycle, to: Cycle);
    /// Reports that FIFO `fifo`, in the order of the wiring by producer, holds `slots` slots from cycle `at` on (law 10). Called
    /// on change, in order of time, with some delay. Before the first call the FIFO holds none.
    fn on_occupancy(&mut self, fifo: usize, at: Cycle, slots: usize) {
        _ = (fifo, at, slots);
    }
    /// Reports that `tokens` tokens of FIFO `fifo` are visible from cycle `at` on. A token is visible until the cycle of its pop,
    /// inclusive. Called on change, in order of time, with some delay. Before the first call no token is visible.
    fn on_visible_count(&mut self, fifo: usize, at: Cycle, tokens: usize) {
        _ = (fifo, at, tokens);
    }
    /// Reports an event of a memory or of one of its clients, with some delay. Events of one [source](MemoryEvent::source) come
    /// in order of time.
    fn on_memory_event(&mut self, event: MemoryEvent) {
        _ = event;
    }
}

/// Wires of a step.
#[derive(Clone, Copy, Debug)]
pub struct StepWires<'a> {
    /// Inputs from which the step takes tokens, one bit each.
    pub taken: u32,
    /// Bits of its tokens, by output.
    pub given: &'a [(usize, TokenBits)],
    /// Its direct memory requests.
    pub requests: &'a [Request],
    /// Its look-ups in caches.
    pub look_ups: &'a [Request],
}

/// Bits of a token, the lowest first.
pub type TokenBits = Vec<u64>;

/// A field of the tokens of a FIFO: its name, its lowest bit, and its width.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TokenField {
    /// Name.
    pub name: String,
    /// Number of its lowest bit.
    pub first: u32,
    /// Width \[bits\].
    pub bits: u32,
}

/// An output FIFO of a unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputWires {
    /// Fields of its tokens.
    pub fields: Vec<TokenField>,
    /// Cycles from delivery to visibility.
    pub latency: u64,
}

/// A table of a unit: its name, the bits of an entry, and the entries.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UnitTable {
    /// Name.
    pub name: String,
    /// Width of an entry \[bits\].
    pub bits: u32,
    /// Entries.
    pub entries: Vec<TokenBits>,
}

impl UnitTable {
    /// Creates a table of one number, for example a latency in cycles.
    pub fn number(name: &str, value: impl Into<u64>) -> Self {
        Self { name: name.into(), bits: 64, entries: vec![vec![value.into()]] }
    }
}

/// Facts about a unit that its hardware twin needs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UnitWires {
    /// Parameters and contents that follow from the configuration or the run.
    pub tables: Vec<UnitTable>,
    /// Its outputs, in the order of the wiring.
    pub outputs: Vec<OutputWires>,
    /// Credits that its largest step needs, by memory client.
    pub credits: Vec<u32>,
}

/// A probe that observes nothing.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct NoProbe;

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
    fn reads_visible(&self) -> bool {
        (**self).reads_visible()
    }
    fn on_step(&mut self, stage: usize, [taken, asked]: [u32; 2], given: &[(usize, Label)]) {
        (**self).on_step(stage, [taken, asked], given);
    }
    fn reads_wires(&self) -> bool {
        (**self).reads_wires()
    }
    fn on_wires(&mut self, stage: usize, step: &StepWires<'_>) {
        (**self).on_wires(stage, step);
    }
    fn on_visible(&mut self, fifo: usize, at: Cycle) {
        (**self).on_visible(fifo, at);
    }
    fn on_answers(&mut self, stage: usize, step: u64, answers: &[Cycle]) {
        (**self).on_answers(stage, step, answers);
    }
    fn on_unit(&mut self, stage: usize, unit: &UnitWires) {
        (**self).on_unit(stage, unit);
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
    fn on_visible_count(&mut self, fifo: usize, at: Cycle, tokens: usize) {
        (**self).on_visible_count(fifo, at, tokens);
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
    /// By FIFO: number of visible tokens from each cycle on.
    pub visible: Vec<Vec<(Cycle, usize)>>,
    /// Memory events, by source.
    pub memories: BTreeMap<[usize; 4], Vec<MemoryEvent>>,
}

impl Recorder {
    fn add(&mut self, new: Interval) {
        let stage = list_of(&mut self.stages, new.stage);
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
        list_of(&mut self.fifos, fifo).push((at, slots));
    }
    fn on_visible_count(&mut self, fifo: usize, at: Cycle, tokens: usize) {
        list_of(&mut self.visible, fifo).push((at, tokens));
    }
    fn on_memory_event(&mut self, event: MemoryEvent) {
        self.memories.entry(event.source()).or_default().push(event);
    }
}

/// Returns list `number`. Makes it, and those before it, if they are new.
#[inline]
fn list_of<T: Clone>(lists: &mut Vec<Vec<T>>, number: usize) -> &mut Vec<T> {
    if lists.len() <= number {
        lists.resize(number + 1, Vec::new());
    }
    &mut lists[number]
}
