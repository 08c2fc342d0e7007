//! Conserved cycle accounting (law 9).

use crate::Cycle;
use crate::capacity::{MAX_CLIENTS, MAX_LINKS};

/// Cause of a stall of a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StallCause {
    /// Input `i` was the first declared one without a visible token.
    Starved(usize),
    /// Client `i` had too few credits, or the unit waited for an answer on it.
    Memory(usize),
    /// Output `i` was the first one without a free slot.
    Blocked(usize),
}

/// A wait of a stage.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wait {
    pub(crate) cause: StallCause,
    /// Its first cycle, and the cycle after its last.
    pub(crate) from: Cycle,
    pub(crate) to: Cycle,
}

/// Breakdown of a unit's cycles, by number of input, client and output.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CycleAccount {
    /// Cycles in which a step occupied the unit.
    pub busy: u64,
    /// Cycles after its last step.
    pub done: u64,
    /// Cycles without a visible token, by input.
    pub starved: [u64; MAX_LINKS],
    /// Cycles waiting for credits or answers, by client.
    pub memory: [u64; MAX_CLIENTS],
    /// Cycles without a slot, by output.
    pub blocked: [u64; MAX_LINKS],
}

impl CycleAccount {
    /// Charges `cycles` to `cause`.
    #[inline]
    pub fn charge(&mut self, cause: StallCause, cycles: u64) {
        match cause {
            StallCause::Starved(i) => self.starved[i] += cycles,
            StallCause::Memory(i) => self.memory[i] += cycles,
            StallCause::Blocked(i) => self.blocked[i] += cycles,
        }
    }

    /// Sum of all cycles.
    pub fn total(&self) -> u64 {
        let sum = |v: &[u64]| v.iter().sum::<u64>();
        self.busy + self.done + sum(&self.starved) + sum(&self.memory) + sum(&self.blocked)
    }
}
