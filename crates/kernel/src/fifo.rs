//! Bounded FIFOs: the wires between units.

use crate::{Cycle, Link};

/// A bounded FIFO of tokens.
#[derive(Clone, Debug)]
pub struct Fifo<T> {
    pub(crate) link: Link,
    tokens: Box<[Option<T>]>,
}

impl<T> Fifo<T> {
    /// A FIFO of `depth` >= 1 slots and `latency` >= 1 cycles from delivery to visibility.
    ///
    /// # Panics
    /// If depth or latency is 0 (law 1).
    pub fn new(name: &str, depth: usize, latency: u64) -> Self {
        let link = Link::new(name, depth, latency);
        Self { tokens: (0..depth.next_power_of_two()).map(|_| None).collect(), link }
    }

    /// Reserves a slot at the start of the step that emits `token`, if it emits one; 1 if it did, else 0.
    #[inline(always)]
    pub(crate) fn reserve(&mut self, start: Cycle, token: Option<T>) -> u32 {
        let emitted = u32::from(token.is_some());
        if emitted == 1 {
            let (_, back) = self.link.ends();
            self.tokens[back] = token;
            self.link.reserve(start);
        }
        emitted
    }

    /// Takes the front token out, if it is declared.
    #[inline(always)]
    pub(crate) fn pop_if(&mut self, declared: bool, at: Cycle) -> Option<T> {
        if !declared {
            return None;
        }
        let (front, _) = self.link.ends();
        self.link.pop(at);
        self.tokens[front].take()
    }

    /// As [`Fifo::reserve`] and delivery, without time.
    #[inline]
    pub(crate) fn put(&mut self, token: Option<T>) {
        if token.is_some() {
            let (_, back) = self.link.ends();
            self.tokens[back] = token;
            self.link.count_push();
        }
    }

    /// As [`Fifo::pop_if`], without time.
    #[inline]
    pub(crate) fn take_if(&mut self, declared: bool) -> Option<T> {
        if !declared {
            return None;
        }
        let (front, _) = self.link.ends();
        self.link.count_pop();
        self.tokens[front].take()
    }
}
