//! Bounded FIFOs: the wires between units.

use crate::{FifoInfo, Label, TokenBits, TokenField};
use std::sync::Arc;

/// Slots of a ring at first.
const FIRST_SLOTS: usize = 8;

/// A bounded FIFO of tokens.
#[derive(Clone, Debug)]
pub struct Fifo<T> {
    pub(crate) link: FifoInfo,
    /// Slots in a ring, a power of two. Token n lies in slot n modulo their number. (With a `VecDeque` the compiler copies each
    /// token once more.)
    slots: Vec<Option<T>>,
    /// Returns the label of a token.
    label: fn(&T) -> Label,
    /// Returns the bits of a token.
    pack: TokenPacker<T>,
}

/// Functions that return the bits of a token, and the fields of all tokens.
struct TokenPacker<T> {
    pack: Arc<dyn Fn(&T) -> TokenBits + Send + Sync>,
    fields: Arc<dyn Fn() -> Vec<TokenField> + Send + Sync>,
}

impl<T> Clone for TokenPacker<T> {
    fn clone(&self) -> Self {
        Self { pack: Arc::clone(&self.pack), fields: Arc::clone(&self.fields) }
    }
}

impl<T> std::fmt::Debug for TokenPacker<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("TokenPacker")
    }
}

impl<T> Fifo<T> {
    /// A FIFO of `depth` >= 1 slots and `latency` >= 1 cycles from delivery to visibility.
    ///
    /// # Panics
    /// If depth or latency is 0 (law 1).
    pub fn new(name: &str, depth: usize, latency: u64) -> Self {
        let pack = TokenPacker { pack: Arc::new(|_: &T| TokenBits::new()), fields: Arc::new(Vec::new) };
        let (link, label) = (FifoInfo::new(name, depth, latency), |_: &T| Label::default());
        Self { link, slots: std::iter::repeat_with(|| None).take(FIRST_SLOTS).collect(), label, pack }
    }

    /// Sets the width of a slot \[bits\]. It matters for hardware counts only.
    #[must_use]
    pub fn carrying(mut self, bits: u32) -> Self {
        self.link.set_bits(bits);
        self
    }

    /// Makes the FIFO periodic: tokens become visible only in multiples of `period` >= 1 cycles (law 1). An example is a buffer
    /// flip, which waits for the vertical blank of a display.
    ///
    /// # Panics
    /// If the period is 0.
    #[must_use]
    pub fn with_period(mut self, period: u64) -> Self {
        self.link.set_period(period);
        self
    }

    /// Sets the function that labels tokens, for probes that read labels.
    #[must_use]
    pub fn labelled(mut self, label: fn(&T) -> Label) -> Self {
        self.label = label;
        self
    }

    /// Sets the functions that pack a token into bits and list its fields, for probes that read wires.
    #[must_use]
    pub fn packed(
        mut self,
        pack: impl Fn(&T) -> TokenBits + Send + Sync + 'static,
        fields: impl Fn() -> Vec<TokenField> + Send + Sync + 'static,
    ) -> Self {
        self.pack = TokenPacker { pack: Arc::new(pack), fields: Arc::new(fields) };
        self
    }

    /// Returns the fields of the tokens.
    pub(crate) fn fields(&self) -> Vec<TokenField> {
        (self.pack.fields)()
    }

    /// Returns the bits of the newest token.
    pub(crate) fn newest_bits(&self) -> TokenBits {
        self.newest().map(|token| (self.pack.pack)(token)).unwrap_or_default()
    }

    /// Returns the label of the newest token.
    pub(crate) fn newest_label(&self) -> Label {
        self.newest().map(self.label).unwrap_or_default()
    }

    /// Returns the newest token, if it is still inside.
    fn newest(&self) -> Option<&T> {
        self.slots.get(self.slot(self.link.pushed().wrapping_sub(1)))?.as_ref()
    }

    /// Returns the slot of a token.
    #[inline(always)]
    fn slot(&self, number: u64) -> usize {
        number as usize & self.slots.len().wrapping_sub(1)
    }

    /// Pushes `token` if it is `Some`. Returns the number of tokens pushed.
    #[inline(always)]
    pub(crate) fn put(&mut self, token: Option<T>) -> u32 {
        if token.is_none() {
            return 0;
        }
        let slot = self.slot(self.link.pushed());
        // The slot is empty. An assignment would drop its content, and then the compiler copies each token once more.
        std::mem::forget(std::mem::replace(&mut self.slots[slot], token));
        self.link.count_push();
        if self.link.len() == self.slots.len() {
            self.grow();
        }
        1
    }

    /// Doubles the ring. (It grows with its tokens, because a FIFO may be far deeper than it is ever full.)
    #[cold]
    #[inline(never)]
    fn grow(&mut self) {
        let first = self.slot(self.link.popped());
        self.slots.rotate_left(first);
        self.slots.resize_with(2 * self.slots.len(), || None);
        let first = self.slot(self.link.popped());
        self.slots.rotate_right(first);
    }

    /// Pops the front token if `declared`.
    #[inline(always)]
    pub(crate) fn take_if(&mut self, declared: bool) -> Option<T> {
        if !declared {
            return None;
        }
        let slot = self.slot(self.link.popped());
        let token = self.slots.get_mut(slot).and_then(Option::take);
        self.link.count_pop();
        token
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growing_ring_keeps_tokens_in_order() {
        let mut fifo = Fifo::new("fifo", 100, 1);
        let mut popped = Vec::new();
        // The ring is full for the first time while its oldest token lies in the middle.
        for token in 0..60_u32 {
            assert_eq!((fifo.put(None), fifo.put(Some(token))), (0, 1));
            assert_eq!(fifo.newest(), Some(&token));
            if token < 5 {
                popped.extend(fifo.take_if(true));
            }
            assert_eq!(fifo.take_if(false), None);
        }
        assert_eq!(fifo.link.len(), 55);
        popped.extend(std::iter::from_fn(|| fifo.take_if(!fifo.link.is_empty())));
        assert!(popped.into_iter().eq(0..60));
    }
}
