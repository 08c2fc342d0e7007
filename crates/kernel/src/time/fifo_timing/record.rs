//! The record of a FIFO: its occupancy, and its delivered tokens.

use super::FifoTiming;
use crate::Cycle;
use crate::memory_events::EventBounds;
use crate::time::kept_tokens::KeptTokens;
use std::cell::Ref;

impl FifoTiming {
    /// See [`OccupancyHistogram::count_nothing`].
    pub(crate) fn count_nothing(&mut self) {
        self.occupancy.get_mut().count_nothing();
    }

    /// Forgets the answers that the steps of tokens wait for.
    pub(crate) fn forget_awaits(&mut self) {
        self.ring.forget_awaits();
    }

    /// See [`OccupancyHistogram::keep_fills`]. The number of visible tokens derives from kept tokens.
    pub(crate) fn keep_fills(&self, visible: bool) {
        self.keep_tokens(visible);
        self.occupancy.borrow_mut().keep_fills(visible);
    }

    /// Keeps delivered tokens from now on, or no more.
    pub(crate) fn keep_tokens(&self, keeps: bool) {
        self.keeps_tokens.set(keeps);
    }

    /// Returns the kept tokens.
    pub(in crate::time) fn kept_tokens(&self) -> Ref<'_, KeptTokens> {
        self.kept.borrow()
    }

    /// Takes the first cycles in which the tokens delivered since the last call can be popped.
    pub(crate) fn take_visible(&self) -> Vec<Cycle> {
        self.kept.take().visible
    }

    /// See [`OccupancyHistogram::take_fills`].
    pub(crate) fn take_fills(&self, end: Option<Cycle>) -> Vec<(Cycle, usize)> {
        self.occupancy.borrow_mut().take_fills(end)
    }

    /// See [`OccupancyHistogram::emit_visible`].
    pub(crate) fn emit_visible(&self, visible: &[Cycle], bounds: EventBounds, emit: impl FnMut(Cycle, usize)) {
        self.occupancy.borrow_mut().emit_visible(visible, bounds, emit);
    }

    /// Settles a run of `total` cycles and returns the histogram: `histogram[k]` cycles with k slots held (law 10).
    pub(crate) fn finish(&self, total: u64) -> Vec<u64> {
        self.occupancy.borrow_mut().finish(&self.ring, self.pushed.get(), self.popped.get(), Cycle(total))
    }

    /// Counts the slots in use in cycle `now`, after the actions of that cycle: law 10 taken literally.
    pub(crate) fn count_held(&self, now: Cycle) {
        // A slot popped in this cycle is in use until its end.
        let last = self.popped.get().checked_sub(1).map(|last| self.ring.token(last).free.get());
        let pops = last == Some(now + 1);
        self.occupancy.borrow_mut().count(self.len() + usize::from(pops), pops, now);
    }
}
