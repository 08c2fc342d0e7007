//! Places in the steps of a stage, for walks back in time.

use super::path_tracer::{StartTerm, TracedStage};
use super::{CompactStep, MachineTiming, StepTiming};
use crate::Cycle;
use crate::capacity::MAX_LINKS;

/// A step of a stage, with its start and the tokens before it. A path comes to the steps of a stage from the last to the first, so it
/// moves over each of them once.
#[derive(Debug)]
pub(super) struct StageCursor<'a> {
    steps: &'a [CompactStep],
    traced: &'a TracedStage,
    /// Number of the step.
    number: u32,
    start: Cycle,
    /// Tokens that earlier steps took, by input.
    taken: [u32; MAX_LINKS],
    /// Tokens that earlier steps made, by output.
    made: [u32; MAX_LINKS],
}

impl<'a> StageCursor<'a> {
    /// Returns the place behind the last step of a run.
    pub(super) fn at_end(time: &MachineTiming, stage: usize, steps: &'a [CompactStep], traced: &'a TracedStage) -> Self {
        let clock = &time.stages[stage];
        let (number, start) = (traced.steps.len() as u32, traced.last);
        let mut cursor = Self { steps, traced, number, start, taken: [0; MAX_LINKS], made: [0; MAX_LINKS] };
        for (input, fifo) in clock.inputs.of(clock.inputs.all()) {
            cursor.taken[input] = time.fifos[fifo].popped() as u32;
        }
        for (output, fifo) in clock.outputs.of(clock.outputs.all()) {
            cursor.made[output] = time.fifos[fifo].tokens() as u32;
        }
        cursor
    }

    /// Number of the step.
    pub(super) fn number(&self) -> u32 {
        self.number
    }

    /// Start of the step.
    pub(super) fn start(&self) -> Cycle {
        self.start
    }

    /// The term that bound its start.
    pub(super) fn bound_by(&self) -> StartTerm {
        self.traced.steps[self.number as usize].bound_by
    }

    /// Its timing without memory.
    pub(super) fn timing(&self) -> StepTiming {
        self.steps[self.number as usize].timing()
    }

    /// Tokens of an input before the step.
    pub(super) fn taken(&self, input: u8) -> u32 {
        self.taken[usize::from(input) % MAX_LINKS]
    }

    /// Tokens of an output before the step.
    pub(super) fn made(&self, output: u8) -> u32 {
        self.made[usize::from(output) % MAX_LINKS]
    }

    /// Moves back as long as the place is `behind` the wanted one.
    pub(super) fn go_back(&mut self, behind: impl Fn(&Self) -> bool) {
        while behind(self)
            && let Some(before) = self.number.checked_sub(1)
        {
            if (self.number as usize) < self.traced.steps.len() {
                self.start = Cycle(self.start.0 - self.traced.after(self.number));
            }
            self.number = before;
            let [inputs, outputs] = self.steps[before as usize].tokens();
            subtract(&mut self.taken, inputs);
            subtract(&mut self.made, outputs);
        }
    }
}

/// Subtracts one from the counts of these bits.
#[inline(always)]
fn subtract(counts: &mut [u32; MAX_LINKS], mut bits: u8) {
    while bits != 0 {
        counts[bits.trailing_zeros() as usize] -= 1;
        bits &= bits - 1;
    }
}
