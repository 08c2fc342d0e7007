//! The times of a FIFO: laws 1, 2 and 10.

use super::occupancy::Occupancy;
use crate::Cycle;
use crate::wiring::MAX_CLIENTS;

/// Times of one slot.
#[derive(Clone, Copy, Debug)]
struct Times {
    /// When the token in it can be popped; unknown until that is, and while there is none.
    visible: Cycle,
    /// From when on it is free: the cycle after the last pop; unknown while a token is in it.
    free: Cycle,
}

/// The times of one FIFO.
///
/// A ring of as many entries as there are slots keeps, for each, when its token becomes visible and when it was popped. So the
/// start of the next step at either end is known without any clock, each with one look.
#[derive(Clone, Debug)]
pub(crate) struct Slots {
    ring: Box<[Times]>,
    /// Places in the ring of the next push, delivery and pop.
    push: usize,
    delivery: usize,
    pop: usize,
    latency: u64,
    /// The next token delivered is not visible before.
    next_visible: Cycle,
    pushed: u64,
    popped: u64,
    /// The producer makes no step before, as far as it has promised.
    no_push_before: Cycle,
    /// The consumer makes no step before, as far as it has promised.
    no_pop_before: Cycle,
    /// Per slot, the answers that the producer's step waits for, by client; kept after the pop (law 9). Empty where the
    /// producer has no memory client.
    awaits: Box<[[Cycle; MAX_CLIENTS]]>,
    occupancy: Occupancy,
}

impl Slots {
    /// Of a FIFO of `depth` slots whose tokens are visible `latency` cycles after delivery; `awaits`: whether its producer has
    /// memory clients, so that each slot keeps their answers.
    pub(crate) fn new(depth: usize, latency: u64, awaits: bool) -> Self {
        let empty = Times { visible: Cycle::UNKNOWN, free: Cycle::ZERO };
        Self {
            ring: vec![empty; depth].into(),
            push: 0,
            delivery: 0,
            pop: 0,
            latency,
            next_visible: Cycle::ZERO,
            pushed: 0,
            popped: 0,
            no_push_before: Cycle::ZERO,
            no_pop_before: Cycle::ZERO,
            awaits: vec![[Cycle::ZERO; MAX_CLIENTS]; if awaits { depth } else { 0 }].into(),
            occupancy: Occupancy::new(depth),
        }
    }

    /// Tokens inside, delivered or not.
    #[inline]
    pub(crate) fn len(&self) -> usize {
        (self.pushed - self.popped) as usize
    }

    /// Whether no token is inside.
    pub(crate) fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Tokens pushed so far.
    pub(crate) fn tokens(&self) -> u64 {
        self.pushed
    }

    /// The last cycle in which a token became visible.
    pub(crate) fn last_visible(&self) -> Option<Cycle> {
        self.next_visible.0.checked_sub(1).map(Cycle)
    }

    /// The place after another in the ring.
    #[inline(always)]
    fn after(&self, place: usize) -> usize {
        if place + 1 == self.ring.len() { 0 } else { place + 1 }
    }

    /// When the front token is visible; unknown while there is none or its delivery is not known.
    #[inline(always)]
    pub(crate) fn front_visible(&self) -> Cycle {
        self.ring[self.pop].visible
    }

    /// The first cycle in which the next push finds a slot (law 2): the cycle after the pop of token n - depth.
    #[inline(always)]
    pub(crate) fn room_at(&self) -> Cycle {
        self.ring[self.push].free
    }

    /// As [`Slots::front_visible`]; where that is unknown, the front token is not visible before.
    #[inline]
    pub(crate) fn no_front_before(&self) -> Cycle {
        match self.front_visible() {
            Cycle::UNKNOWN if self.popped < self.pushed => self.next_visible,
            Cycle::UNKNOWN => (self.no_push_before + self.latency).max(self.next_visible),
            visible => visible,
        }
    }

    /// As [`Slots::room_at`]; where that is unknown, no slot is free before.
    #[inline]
    pub(crate) fn no_room_before(&self) -> Cycle {
        match self.room_at() {
            Cycle::UNKNOWN => self.no_pop_before + 1,
            room => room,
        }
    }

    /// The producer makes no step before `start`.
    #[inline]
    pub(crate) fn promise_push(&mut self, start: Cycle) {
        self.no_push_before = start;
    }

    /// The consumer makes no step before `start`.
    #[inline]
    pub(crate) fn promise_pop(&mut self, start: Cycle) {
        self.no_pop_before = start;
    }

    /// Law 9: until when the oldest slot holder, which keeps the next push waiting, waits itself for `client`'s answer.
    /// Meaningful while the FIFO is full; unknown while the answer is.
    #[inline]
    pub(crate) fn oldest_awaits(&self, client: usize) -> Cycle {
        self.awaits.get(self.push).map_or(Cycle::ZERO, |answers| answers[client])
    }

    /// The answers that the front token's step waited for, by client; none where its producer has no client.
    pub(super) fn front_answers(&self) -> Option<&[Cycle; MAX_CLIENTS]> {
        self.awaits.get(self.pop)
    }

    /// Records until when the next token to be delivered waits for each client's answer.
    #[inline]
    pub(crate) fn set_awaits(&mut self, answers: [Cycle; MAX_CLIENTS]) {
        if let Some(awaits) = self.awaits.get_mut(self.delivery) {
            *awaits = answers;
        }
    }

    /// Reserves a slot at the start of the step that fills it.
    #[inline(always)]
    pub(crate) fn reserve(&mut self, start: Cycle) {
        self.occupancy.push(start);
        if let Some(awaits) = self.awaits.get_mut(self.push) {
            *awaits = [Cycle::ZERO; MAX_CLIENTS];
        }
        self.ring[self.push].free = Cycle::UNKNOWN;
        self.push = self.after(self.push);
        self.pushed += 1;
    }

    /// Delivers the oldest reserved token (law 1): visible from max(d + f, visible time of the token before it + 1).
    #[inline(always)]
    pub(crate) fn deliver(&mut self, delivered: Cycle) {
        let visible = (delivered + self.latency).max(self.next_visible);
        self.ring[self.delivery].visible = visible;
        self.next_visible = visible + 1;
        self.delivery = self.after(self.delivery);
    }

    /// Pops the front token.
    #[inline(always)]
    pub(crate) fn pop(&mut self, at: Cycle) {
        self.ring[self.pop] = Times { visible: Cycle::UNKNOWN, free: at + 1 };
        self.pop = self.after(self.pop);
        self.popped += 1;
        self.occupancy.pop(at);
    }

    /// See [`Occupancy::keep_fills`].
    pub(crate) fn keep_fills(&mut self) {
        self.occupancy.keep_fills();
    }

    /// See [`Occupancy::take_fills`].
    pub(crate) fn take_fills(&mut self, end: Option<Cycle>) -> Vec<(Cycle, usize)> {
        self.occupancy.take_fills(end)
    }

    /// Settles a run of `total` cycles and returns the histogram: `histogram[k]` cycles with k slots held (law 10).
    pub(crate) fn finish(&mut self, total: u64) -> &[u64] {
        self.occupancy.finish(Cycle(total))
    }

    /// Counts the slots held in cycle `now`, after the actions of that cycle: law 10 read literally.
    pub(crate) fn count_held(&mut self, now: Cycle) {
        let last = if self.pop == 0 { self.ring.len() - 1 } else { self.pop - 1 };
        let is_held = |times: &Times| times.free == now + 1;
        // The slot of the last pop may have been reserved again in the same cycle: not before the one after, by law 2.
        let held = self.len() + usize::from(self.popped > 0 && is_held(&self.ring[last]));
        self.occupancy.count(held, now);
    }
}
