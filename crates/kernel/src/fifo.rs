//! Bounded FIFOs: the wires between units.

use crate::{FifoInfo, Label};
use std::collections::VecDeque;

/// A bounded FIFO of tokens.
#[derive(Clone, Debug)]
pub struct Fifo<T> {
    pub(crate) link: FifoInfo,
    tokens: VecDeque<T>,
    /// What a token is about.
    label: fn(&T) -> Label,
}

impl<T> Fifo<T> {
    /// A FIFO of `depth` >= 1 slots and `latency` >= 1 cycles from delivery to visibility.
    ///
    /// # Panics
    /// If depth or latency is 0 (law 1).
    pub fn new(name: &str, depth: usize, latency: u64) -> Self {
        Self { link: FifoInfo::new(name, depth, latency), tokens: VecDeque::with_capacity(depth), label: |_| Label::default() }
    }

    /// The same with slots of this width \[bits\]: what a token takes in hardware, which only says what the FIFO is built of.
    #[must_use]
    pub fn carrying(mut self, bits: u32) -> Self {
        self.link.set_bits(bits);
        self
    }

    /// The same with tokens that say by `label` what they are about: for probes that ask.
    #[must_use]
    pub fn labelled(mut self, label: fn(&T) -> Label) -> Self {
        self.label = label;
        self
    }

    /// What the token is about that was taken in last.
    pub(crate) fn newest_label(&self) -> Label {
        self.tokens.back().map(self.label).unwrap_or_default()
    }

    /// Takes `token` in, if there is one; 1 if there was, else 0.
    #[inline(always)]
    pub(crate) fn put(&mut self, token: Option<T>) -> u32 {
        let Some(token) = token else { return 0 };
        self.tokens.push_back(token);
        self.link.count_push();
        1
    }

    /// Takes the front token out, if it is declared.
    #[inline(always)]
    pub(crate) fn take_if(&mut self, declared: bool) -> Option<T> {
        if !declared {
            return None;
        }
        self.link.count_pop();
        self.tokens.pop_front()
    }
}
