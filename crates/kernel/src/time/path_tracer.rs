//! The record of a run from which its critical path is [found](super::path_walk) afterwards: for every step the cycles since the step
//! before, and the term of law 3 that bound its start.
//!
//! A path passes few of the steps, so their segments are found only afterwards, and so are the numbers of tokens and requests. With the
//! segments of every step kept instead, a resimulation of W1 with its path took 8 % more instructions; with the steps that make and take
//! each token kept as well, 16 % more.

use super::{FifoTiming, InputMask, MachineTiming, StageArity, StageClock, StageVisit};
use crate::port::Completion;
use crate::{Cycle, MemorySystem};
use std::collections::BTreeMap;

/// The term of law 3 that bound a start, with the number of the input, output or client within the unit.
#[derive(Clone, Copy, Debug)]
pub(super) enum StartTerm {
    /// The end of the step before.
    Free,
    /// The last answer to the blocking step before.
    Answer(u8),
    /// A token.
    Token(u8),
    /// The credit that came with an answer.
    Credit(u8),
    /// A slot.
    Slot(u8),
    /// None of these.
    Rest,
}

/// A step.
#[derive(Clone, Copy, Debug)]
pub(super) struct TracedStep {
    /// Cycles since the start of the step before, or [`FAR`].
    after: u32,
    pub(super) bound_by: StartTerm,
}

/// The value of [`TracedStep::after`] for 2^32 - 1 cycles or more.
const FAR: u32 = u32::MAX;

/// The steps of a stage so far.
#[derive(Debug, Default)]
pub(super) struct TracedStage {
    pub(super) steps: Vec<TracedStep>,
    /// Start of the last step.
    pub(super) last: Cycle,
    /// For steps that are [`FAR`] behind the step before: by number, the cycles between them.
    far: BTreeMap<u32, u64>,
}

impl TracedStage {
    #[inline(always)]
    fn push(&mut self, start: Cycle, bound_by: StartTerm) {
        let after = start.since(self.last);
        if after >= FAR.into() {
            self.far.insert(self.steps.len() as u32, after);
        }
        self.steps.push(TracedStep { after: after.min(FAR.into()) as u32, bound_by });
        self.last = start;
    }

    /// Returns the cycles between a step and the step before.
    pub(super) fn after(&self, number: u32) -> u64 {
        match self.steps[number as usize].after {
            FAR => self.far[&number],
            after => after.into(),
        }
    }

    fn clear(&mut self) {
        self.steps.clear();
        self.far.clear();
        self.last = Cycle::ZERO;
    }
}

/// Steps of a run so far.
#[derive(Debug, Default)]
pub(crate) struct PathTracer {
    /// Steps that may still come; `None` if more came. Such a run has no path.
    left: Option<usize>,
    /// By stage, in order.
    pub(super) stages: Vec<TracedStage>,
    /// For each request of a client the number of the step that issued it, by client. Requests of the last step of a stage are missing:
    /// no later step waits for their credits.
    pub(super) issuers: Vec<Vec<u32>>,
    /// Stage and number of the last step that passes a mark.
    pub(super) marked: Option<(usize, u32)>,
    /// Memory of the completions of requests, between runs.
    completions: Vec<Vec<Completion>>,
}

/// Makes this number of empty lists, of the memory of earlier ones.
fn empty<T: Default>(lists: &mut Vec<T>, count: usize, clear: impl FnMut(&mut T)) {
    lists.resize_with(count, T::default);
    lists.iter_mut().for_each(clear);
}

impl PathTracer {
    /// Begins a run that has a path if it takes `most` steps at most. Uses the memory of the run before.
    pub(crate) fn begin(mut self, time: &mut MachineTiming, most: usize) -> Self {
        time.memories.keep_answers(std::mem::take(&mut self.completions));
        time.fifos.iter().for_each(|fifo| fifo.keep_tokens(true));
        // Numbers of steps have 32 bits.
        (self.left, self.marked) = (Some(most.min(u32::MAX as usize)), None);
        empty(&mut self.stages, time.stages.len(), TracedStage::clear);
        empty(&mut self.issuers, time.memories.clients().len(), Vec::clear);
        self
    }

    /// Returns true if every step was kept.
    pub(crate) fn has_all(&self) -> bool {
        self.left.is_some()
    }

    /// Ends a run. Its memory serves the next.
    pub(crate) fn end(mut self, time: &mut MachineTiming) -> Self {
        self.completions = time.memories.take_answers();
        self
    }

    /// Keeps a step before timing takes it in.
    #[inline(always)]
    pub(crate) fn step<K: StageArity>(&mut self, visit: &StageVisit<'_>, start: Cycle, takes: InputMask, is_marked: bool) {
        let Some(left @ 1..) = self.left else { return self.give_up(visit.fifos) };
        self.left = Some(left - 1);
        let traced = &mut self.stages[visit.stage];
        let number = traced.steps.len() as u32;
        traced.push(start, start_term::<K>(visit, start, takes.inputs()));
        if is_marked {
            self.marked = Some((visit.stage, number));
        }
        if K::HAS_MEMORY && visit.clock.needs.asked {
            self.note_requests(visit.clock, visit.memories, number);
        }
    }

    /// Gives the path up, because there are too many steps.
    #[cold]
    fn give_up(&mut self, fifos: &[FifoTiming]) {
        self.left = None;
        fifos.iter().for_each(|fifo| fifo.keep_tokens(false));
    }

    /// Notes the requests of the step before step `next` of a stage.
    fn note_requests(&mut self, clock: &StageClock, memories: &MemorySystem, next: u32) {
        for &client in &clock.clients {
            let issuers = &mut self.issuers[client];
            for _ in issuers.len()..memories.issued(client) as usize {
                issuers.push(next.saturating_sub(1));
            }
        }
    }
}

/// Returns the term that bound a start. Of equal terms, the unit's own occupancy comes before its tokens, and tokens come before
/// credits and slots.
#[inline(always)]
fn start_term<K: StageArity>(visit: &StageVisit<'_>, start: Cycle, inputs: u32) -> StartTerm {
    let StageVisit { clock, memories, .. } = visit;
    if clock.free == start {
        return StartTerm::Free;
    }
    if K::HAS_MEMORY
        && clock.block.until == start
        && let Some(client) = clock.block.last(start)
    {
        return StartTerm::Answer(client as u8);
    }
    let bound = |at: Cycle, place: usize| (at == start).then_some(place as u8);
    let mut token = None;
    visit.inputs.each(inputs, K::INPUTS, |i, fifo| token = token.or(bound(fifo.front_visible(), i)));
    if let Some(input) = token {
        return StartTerm::Token(input);
    }
    if K::HAS_MEMORY {
        let mut needs = clock.clients.iter().zip(&clock.needs.credits).enumerate();
        let credit = needs.find_map(|(own, (&client, &credits))| bound(memories.credits_at(client, credits), own));
        if let Some(own) = credit {
            return StartTerm::Credit(own);
        }
    }
    let mut slot = None;
    visit.outputs.each(visit.outputs.all(K::OUTPUTS), K::OUTPUTS, |i, fifo| slot = slot.or(bound(fifo.room_at(), i)));
    slot.map_or(StartTerm::Rest, StartTerm::Slot)
}
