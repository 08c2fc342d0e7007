//! The record of a run from which its critical path is [found](super::path_walk) afterwards: for every step its start and the term of
//! law 3 that bound the start, and for every token the steps that made and took it.
//!
//! A path passes few of the steps, so their segments are found only afterwards. With the segments of every step kept instead, a
//! resimulation of W1 with its path took 8 % more instructions.

use super::stage_visit::StageView;
use super::{FifoTiming, InputMask, MachineTiming, StepTiming};
use crate::Cycle;
use crate::port::Completion;

/// Stands for no step.
pub(super) const NO_STEP: u32 = u32::MAX;

/// The term of law 3 that bound a start, with the number of the input, output or client within the unit.
#[derive(Clone, Copy, Debug)]
pub(super) enum StartTerm {
    /// The end of the step before.
    Free,
    /// The last answer to the blocking step before.
    Answer(u8),
    /// This token.
    Token(u8, u32),
    /// The credit that came with the answer to this request.
    Credit(u8, u32),
    /// The slot of this token.
    Slot(u8, u32),
    /// None of these.
    Rest,
}

/// A step.
#[derive(Clone, Copy, Debug)]
pub(super) struct TracedStep {
    pub(super) start: Cycle,
    /// Cycles to its delivery without memory.
    pub(super) latency: u32,
    /// Cycles from the last answer to the delivery, at least.
    pub(super) after_data: u32,
    pub(super) bound_by: StartTerm,
}

/// The steps of a producer that made the tokens of a FIFO, and of a consumer that took them, in order.
#[derive(Clone, Debug, Default)]
pub(super) struct TokenSteps {
    pub(super) made: Vec<u32>,
    pub(super) taken: Vec<u32>,
}

/// Steps of a run so far.
#[derive(Debug, Default)]
pub(crate) struct PathTracer {
    /// Steps that may still come; `None` if more came. Such a run has no path.
    left: Option<usize>,
    /// By stage, in order.
    pub(super) stages: Vec<Vec<TracedStep>>,
    pub(super) fifos: Vec<TokenSteps>,
    /// The step that issued each request, by client.
    pub(super) issued: Vec<Vec<u32>>,
    /// Stage and number of the last step that passes a mark.
    pub(super) marked: Option<(usize, u32)>,
    /// Memory of the completions of requests, between runs.
    completions: Vec<Vec<Completion>>,
}

/// Makes this number of empty vectors, of the memory of earlier ones.
fn empty<T: Default>(vectors: &mut Vec<T>, count: usize, clear: impl FnMut(&mut T)) {
    vectors.resize_with(count, T::default);
    vectors.iter_mut().for_each(clear);
}

impl PathTracer {
    /// Begins a run that has a path if it takes `most` steps at most. Uses the memory of the run before.
    pub(crate) fn begin(mut self, time: &mut MachineTiming, most: usize) -> Self {
        time.memories.keep_answers(std::mem::take(&mut self.completions));
        time.fifos.iter().for_each(|fifo| fifo.keep_tokens(true));
        (self.left, self.marked) = (Some(most.min(NO_STEP as usize)), None);
        empty(&mut self.stages, time.stages.len(), Vec::clear);
        empty(&mut self.issued, time.memories.clients().len(), Vec::clear);
        empty(&mut self.fifos, time.fifos.len(), |TokenSteps { made, taken }| {
            made.clear();
            taken.clear();
        });
        self
    }

    /// Returns true if every step was kept.
    pub(super) fn has_all(&self) -> bool {
        self.left.is_some()
    }

    /// Ends a run. Its memory serves the next.
    pub(crate) fn end(mut self, time: &mut MachineTiming) -> Self {
        self.completions = time.memories.take_answers();
        self
    }

    /// Keeps a step before timing takes it in. (Out of line, so that runs without a path pay nothing.)
    #[cold]
    #[inline(never)]
    pub(crate) fn step(&mut self, visit: &StageView<'_>, start: Cycle, takes: InputMask, made: &StepTiming) {
        let &StageView { stage, clock, fifos, memories } = visit;
        let Some(left) = self.left else { return };
        self.left = left.checked_sub(1);
        if !self.has_all() {
            return fifos.iter().for_each(|fifo| fifo.keep_tokens(false));
        }
        let number = self.stages[stage].len() as u32;
        // All its requests by now came from its last step at the latest.
        for &client in &clock.clients {
            self.issued[client].resize(memories.issued(client) as usize, number.wrapping_sub(1));
        }
        let bound_by = start_term(visit, start, takes.inputs());
        for (_, fifo) in clock.inputs.of(takes.inputs()) {
            self.fifos[fifo].taken.push(number);
        }
        for (_, fifo) in clock.outputs.of(made.outputs) {
            self.fifos[fifo].made.push(number);
        }
        let (latency, after_data) = (clock.known_timing(made).1 as u32, made.after_data);
        self.stages[stage].push(TracedStep { start, latency, after_data, bound_by });
        if made.marked {
            self.marked = Some((stage, number));
        }
    }
}

/// Returns the term that bound a start. Of equal terms, the unit's own occupancy comes before its tokens, and tokens come before
/// credits and slots.
fn start_term(visit: &StageView<'_>, start: Cycle, inputs: u32) -> StartTerm {
    let &StageView { clock, fifos, memories, .. } = visit;
    if clock.free == start {
        return StartTerm::Free;
    }
    if clock.block.until == start
        && let Some(client) = clock.block.last(start)
    {
        return StartTerm::Answer(client as u8);
    }
    if let Some((input, fifo)) = clock.inputs.of(inputs).find(|&(_, fifo)| fifos[fifo].front_visible() == start) {
        return StartTerm::Token(input as u8, fifos[fifo].front_number() as u32);
    }
    for (own, (&client, &credits)) in clock.clients.iter().zip(&clock.needs.credits).enumerate() {
        if memories.credits_at(client, credits) == start {
            return StartTerm::Credit(own as u8, memories.credit_of(client, credits) as u32);
        }
    }
    let slot = |fifo: &FifoTiming| fifo.room_at() == start;
    match clock.outputs.of(clock.outputs.all()).find(|&(_, fifo)| slot(&fifos[fifo])) {
        Some((output, fifo)) => StartTerm::Slot(output as u8, fifos[fifo].next_slot_holder() as u32),
        None => StartTerm::Rest,
    }
}
