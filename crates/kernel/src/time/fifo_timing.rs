//! The times of a FIFO: laws 1, 2 and 10.

use super::occupancy::OccupancyHistogram;
use super::token_times::TokenTimes;
use crate::Cycle;
use crate::capacity::MAX_CLIENTS;
use std::cell::{Cell, RefCell};

/// Tokens after which occupancy is settled: settling each as it came cost 100 instructions, a sweep costs 20. With more of them the
/// times of a machine's FIFOs do not fit into the nearest cache.
const SWEEP: usize = 64;

/// Places of what is news for whom.
const CONSUMER: usize = 0;
const PRODUCER: usize = 1;

/// The times of one FIFO.
///
/// A ring keeps the times of its last tokens: at least of as many as there are slots, so that the start of the next step at either end
/// is known without any clock, each with one look; and of those whose part of the occupancy is not settled.
///
/// Two stages act on a FIFO, and each looks at several of them while it changes its own clock: hence the cells.
#[derive(Clone, Debug)]
pub(crate) struct FifoTiming {
    /// A power of two.
    ring: Box<[TokenTimes]>,
    depth: usize,
    /// Numbers of the next push, delivery and pop.
    pushed: Cell<usize>,
    delivered: Cell<usize>,
    popped: Cell<usize>,
    latency: u64,
    /// When the front token is visible, and from when on the next push finds a slot: asked for at every visit, they change with a token.
    front: Cell<Cycle>,
    room: Cell<Cycle>,
    /// The next token delivered is not visible before.
    next_visible: Cell<Cycle>,
    /// The producer makes no step before, as far as it has promised.
    no_push_before: Cell<Cycle>,
    /// The consumer makes no step before, as far as it has promised.
    no_pop_before: Cell<Cycle>,
    /// What its consumer or its producer may go by has changed since that last looked.
    news: [Cell<bool>; 2],
    /// Of each token in the ring, the answers that the producer's step waits for, by client (law 9). Empty where the producer has no
    /// memory client.
    awaits: Box<[Cell<[Cycle; MAX_CLIENTS]>]>,
    occupancy: RefCell<OccupancyHistogram>,
}

/// The place of a token in a ring of a power of two.
#[inline(always)]
fn place<T>(ring: &[T], number: usize) -> usize {
    number & ring.len().wrapping_sub(1)
}

/// A token in its ring.
#[inline(always)]
fn token(ring: &[TokenTimes], number: usize) -> &TokenTimes {
    &ring[place(ring, number)]
}

impl FifoTiming {
    /// Of a FIFO of `depth` slots whose tokens are visible `latency` cycles after delivery; `awaits`: whether its producer has
    /// memory clients, so that each slot keeps their answers.
    pub(crate) fn new(depth: usize, latency: u64, awaits: bool) -> Self {
        let unused = TokenTimes { reserved: Cell::default(), visible: Cell::new(Cycle::UNKNOWN), free: Cell::default() };
        let tokens = (depth + SWEEP).next_power_of_two();
        Self {
            ring: vec![unused; tokens].into(),
            depth,
            pushed: Cell::new(0),
            delivered: Cell::new(0),
            popped: Cell::new(0),
            latency,
            front: Cell::new(Cycle::UNKNOWN),
            room: Cell::default(),
            next_visible: Cell::default(),
            no_push_before: Cell::default(),
            no_pop_before: Cell::default(),
            news: Default::default(),
            awaits: vec![Cell::default(); if awaits { tokens } else { 0 }].into(),
            occupancy: OccupancyHistogram::new(depth).into(),
        }
    }

    /// Tokens inside, delivered or not.
    #[inline]
    pub(crate) fn len(&self) -> usize {
        self.pushed.get() - self.popped.get()
    }

    /// Whether no token is inside.
    pub(crate) fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Tokens pushed so far.
    pub(crate) fn tokens(&self) -> u64 {
        self.pushed.get() as u64
    }

    /// The last cycle in which a token became visible.
    pub(crate) fn last_visible(&self) -> Option<Cycle> {
        self.next_visible.get().0.checked_sub(1).map(Cycle)
    }

    /// The number of the token whose slot the next one takes.
    #[inline(always)]
    fn slot(&self) -> usize {
        self.pushed.get().wrapping_sub(self.depth)
    }

    /// When the front token is visible; unknown while there is none or its delivery is not known.
    #[inline(always)]
    pub(crate) fn front_visible(&self) -> Cycle {
        self.front.get()
    }

    /// The first cycle in which the next push finds a slot (law 2): the cycle after the pop of token n - depth.
    #[inline(always)]
    pub(crate) fn room_at(&self) -> Cycle {
        self.room.get()
    }

    /// As [`FifoTiming::front_visible`]; where that is unknown, the front token is not visible before.
    #[inline]
    pub(crate) fn no_front_before(&self) -> Cycle {
        match self.front_visible() {
            Cycle::UNKNOWN if self.popped < self.pushed => self.next_visible.get(),
            Cycle::UNKNOWN => (self.no_push_before.get() + self.latency).max(self.next_visible.get()),
            visible => visible,
        }
    }

    /// As [`FifoTiming::room_at`]; where that is unknown, no slot is free before.
    #[inline]
    pub(crate) fn no_room_before(&self) -> Cycle {
        match self.room_at() {
            Cycle::UNKNOWN => self.no_pop_before.get() + 1,
            room => room,
        }
    }

    /// The producer makes no step before `start`.
    #[inline]
    pub(crate) fn promise_push(&self, start: Cycle) {
        // While there is a token, the consumer goes by that.
        if self.no_push_before.replace(start) != start && self.is_empty() {
            self.news[CONSUMER].set(true);
        }
    }

    /// The consumer makes no step before `start`.
    #[inline]
    pub(crate) fn promise_pop(&self, start: Cycle) {
        if self.no_pop_before.replace(start) != start && !self.room_at().is_known() {
            self.news[PRODUCER].set(true);
        }
    }

    /// Law 9: until when the oldest slot holder, which keeps the next push waiting, waits itself for `client`'s answer.
    /// Meaningful while the FIFO is full; unknown while the answer is.
    #[inline]
    pub(crate) fn oldest_awaits(&self, client: usize) -> Cycle {
        self.awaits.get(place(&self.awaits, self.slot())).map_or(Cycle::ZERO, |answers| answers.get()[client])
    }

    /// The answers that the front token's step waited for, by client; none where its producer has no client.
    pub(super) fn front_answers(&self) -> Option<[Cycle; MAX_CLIENTS]> {
        self.awaits.get(place(&self.awaits, self.popped.get())).map(Cell::get)
    }

    /// Records until when the next token to be delivered waits for each client's answer.
    #[inline]
    pub(crate) fn set_awaits(&self, answers: [Cycle; MAX_CLIENTS]) {
        if let Some(awaits) = self.awaits.get(place(&self.awaits, self.delivered.get())) {
            awaits.set(answers);
        }
    }

    /// Reserves a slot at the start of the step that fills it.
    #[inline(always)]
    pub(crate) fn reserve(&self, start: Cycle) {
        let (ring, number) = (&*self.ring, self.pushed.get());
        let new = token(ring, number);
        new.reserved.set(start);
        new.free.set(Cycle::UNKNOWN);
        // What stands at the place behind is older than the ring.
        token(ring, number + 1).visible.set(Cycle::UNKNOWN);
        if let Some(awaits) = self.awaits.get(place(&self.awaits, number)) {
            awaits.set(Default::default());
        }
        self.pushed.set(number + 1);
        self.room.set(token(ring, self.slot()).free.get());
        if (number + 1).is_multiple_of(SWEEP) {
            self.settle();
        }
    }

    /// Delivers the oldest reserved token (law 1): visible from max(d + f, visible time of the token before it + 1).
    #[inline(always)]
    pub(crate) fn deliver(&self, delivered: Cycle) {
        let visible = delivered.after(self.latency).max(self.next_visible.get());
        let number = self.delivered.get();
        token(&self.ring, number).visible.set(visible);
        self.next_visible.set(visible.after(1));
        self.delivered.set(number + 1);
        if number == self.popped.get() {
            self.front.set(visible);
            self.news[CONSUMER].set(true);
        }
    }

    /// Pops the front token.
    #[inline(always)]
    pub(crate) fn pop(&self, at: Cycle) {
        let (ring, number, free) = (&*self.ring, self.popped.get(), at.after(1));
        token(ring, number).free.set(free);
        self.popped.set(number + 1);
        self.front.set(token(ring, number + 1).visible.get());
        if number + self.depth == self.pushed.get() {
            self.room.set(free);
            self.news[PRODUCER].set(true);
        }
    }

    /// Whether there is news for its consumer since the last call.
    #[inline(always)]
    pub(super) fn has_news_for_consumer(&self) -> bool {
        self.news[CONSUMER].take()
    }

    /// The same for its producer.
    #[inline(always)]
    pub(super) fn has_news_for_producer(&self) -> bool {
        self.news[PRODUCER].take()
    }

    #[inline(never)]
    fn settle(&self) {
        self.occupancy.borrow_mut().settle(&self.ring, (self.pushed.get(), self.popped.get()));
    }

    /// See [`OccupancyHistogram::count_nothing`]. Nor does anybody ask why it waited.
    pub(crate) fn count_nothing(&mut self) {
        self.occupancy.get_mut().count_nothing();
        self.awaits = Box::default();
    }

    /// See [`OccupancyHistogram::keep_fills`].
    pub(crate) fn keep_fills(&self) {
        self.occupancy.borrow_mut().keep_fills();
    }

    /// See [`OccupancyHistogram::take_fills`].
    pub(crate) fn take_fills(&self, end: Option<Cycle>) -> Vec<(Cycle, usize)> {
        self.occupancy.borrow_mut().take_fills(end)
    }

    /// Settles a run of `total` cycles and returns the histogram: `histogram[k]` cycles with k slots held (law 10).
    pub(crate) fn finish(&self, total: u64) -> Vec<u64> {
        self.occupancy.borrow_mut().finish(&self.ring, (self.pushed.get(), self.popped.get()), Cycle(total))
    }

    /// Counts the slots held in cycle `now`, after the actions of that cycle: law 10 read literally.
    pub(crate) fn count_held(&self, now: Cycle) {
        // Popped in this cycle, its slot is held to its end.
        let last = self.popped.get().checked_sub(1).map(|last| token(&self.ring, last).free.get());
        let held = self.len() + usize::from(last == Some(now + 1));
        self.occupancy.borrow_mut().count(held, now);
    }
}
