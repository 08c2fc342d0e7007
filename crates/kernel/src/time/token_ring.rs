//! Times of the last tokens of a FIFO.

use crate::Cycle;
use crate::capacity::MAX_CLIENTS;
use std::cell::Cell;

/// Times of one token.
#[derive(Clone, Debug)]
pub(super) struct TokenTimes {
    /// Start of the step that reserved a slot for it.
    pub(super) reserved: Cell<Cycle>,
    /// First cycle in which the token after it can be popped; unknown until that is delivered. (It is kept here, because both ends need it
    /// with the other times of this token.)
    pub(super) next_visible: Cell<Cycle>,
    /// First cycle in which its slot is free again, the cycle after its pop; unknown before the pop.
    pub(super) free: Cell<Cycle>,
}

impl TokenTimes {
    /// Creates the times of an entry that was never used.
    fn unused() -> Self {
        Self { reserved: Cell::default(), next_visible: Cell::new(Cycle::UNKNOWN), free: Cell::default() }
    }
}

/// Times of the last tokens of a FIFO, in a ring. Its length is a power of two.
#[derive(Clone, Debug, Default)]
pub(super) struct TokenRing {
    tokens: Vec<TokenTimes>,
    /// For each token, the answers that its producer's step waits for, by client (law 9). Empty if the producer has no memory client.
    awaits: Vec<Cell<[Cycle; MAX_CLIENTS]>>,
}

/// Doubles a ring. Its last tokens, before `pushed`, move to their places in the longer ring.
fn double<T: Clone>(ring: &mut Vec<T>, pushed: usize, unused: T) {
    let length = ring.len();
    ring.resize(2 * length, unused);
    for number in pushed.saturating_sub(length)..pushed {
        let to = place(ring, number);
        if to >= length {
            ring.swap(to - length, to);
        }
    }
}

/// Place of a token in a ring.
#[inline(always)]
fn place<T>(ring: &[T], number: usize) -> usize {
    number & ring.len().wrapping_sub(1)
}

impl TokenRing {
    /// Refills memory with so many entries that were never used. `awaits`: true if tokens have awaited answers.
    pub(super) fn in_memory(mut memory: Self, length: usize, awaits: bool) -> Self {
        memory.tokens.clear();
        memory.awaits.clear();
        memory.tokens.resize(length, TokenTimes::unused());
        memory.awaits.resize(if awaits { length } else { 0 }, Cell::default());
        memory
    }

    /// Doubles the ring, and keeps the tokens in it. `pushed`: number of the next token.
    pub(super) fn double(&mut self, pushed: usize) {
        double(&mut self.tokens, pushed, TokenTimes::unused());
        double(&mut self.awaits, pushed, Cell::default());
    }

    /// Number of entries.
    pub(super) fn len(&self) -> usize {
        self.tokens.len()
    }

    /// Forgets the awaited answers.
    pub(super) fn forget_awaits(&mut self) {
        self.awaits.clear();
    }

    /// Returns the times of a token.
    #[inline(always)]
    pub(super) fn token(&self, number: usize) -> &TokenTimes {
        &self.tokens[place(&self.tokens, number)]
    }

    /// Returns the times of tokens in a row, up to `end` or the end of the ring.
    pub(super) fn run(&self, first: usize, end: usize) -> &[TokenTimes] {
        let from = place(&self.tokens, first);
        &self.tokens[from..self.tokens.len().min(from + (end - first))]
    }

    /// Returns the awaited answers of a token.
    #[inline(always)]
    pub(super) fn awaits(&self, number: usize) -> Option<&Cell<[Cycle; MAX_CLIENTS]>> {
        self.awaits.get(place(&self.awaits, number))
    }
}
