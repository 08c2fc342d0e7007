//! Times of a FIFO: laws 1, 2 and 10.

mod record;

use super::kept_tokens::{AnsweredDelivery, KeptTokens};
use super::occupancy::OccupancyHistogram;
use super::token_ring::TokenRing;
use crate::Cycle;
use crate::capacity::MAX_CLIENTS;
use crate::netlist::FifoSpec;
use std::cell::{Cell, RefCell};

/// Tokens between two settlements of the occupancy. Settling each token as it came cost 100 instructions; a sweep costs 20. With
/// a larger number, the times of a machine's FIFOs do not fit into the first-level cache.
const SWEEP: usize = 64;

/// Tokens of a ring at power-on, if its FIFO is deep. Rings that began with room for 65,536 tokens caused 40 % of the page faults of
/// bottleneck analysis.
const FIRST_RING: usize = 2 * SWEEP;

/// Memory of the times of a FIFO, for one run after the other.
#[derive(Clone, Debug, Default)]
pub(crate) struct FifoMemory {
    ring: TokenRing,
    kept: KeptTokens,
}

/// Indices of `news`.
const CONSUMER: usize = 0;
const PRODUCER: usize = 1;

/// Times of one FIFO.
///
/// A ring keeps the times of its last tokens: at least as many as there are slots, so that the start of the next step at either
/// end is found with one access; and all tokens whose occupancy is not settled. The ring of a deep FIFO begins small, and
/// [grows](FifoTiming::grow) while it holds too many tokens, until it has its full length.
///
/// Two stages act on a FIFO, and each reads several FIFOs while it changes its own clock. Hence the cells.
#[derive(Clone, Debug)]
pub(crate) struct FifoTiming {
    ring: TokenRing,
    /// True if the ring has no room for the tokens up to the next settlement.
    must_grow: Cell<bool>,
    depth: usize,
    /// Tokens between the next push and the token whose slot it takes: the depth, or 0 as long as the ring is not full-grown. Until
    /// then, the entry of the next push has a time that no later push waits for.
    slots_back: usize,
    /// Numbers of the next push, delivery and pop.
    pushed: Cell<usize>,
    delivered: Cell<usize>,
    popped: Cell<usize>,
    latency: u64,
    period: u64,
    /// First visible cycle of the front token, and first cycle with a free slot for the next push. Every visit reads them, and
    /// they change with each token.
    front: Cell<Cycle>,
    room: Cell<Cycle>,
    /// The next delivered token is not visible before this cycle.
    next_visible: Cell<Cycle>,
    /// The producer has promised no step before this cycle.
    no_push_before: Cell<Cycle>,
    /// The consumer has promised no step before this cycle.
    no_pop_before: Cell<Cycle>,
    /// True if values for the consumer or the producer have changed since it last looked.
    news: [Cell<bool>; 2],
    occupancy: RefCell<OccupancyHistogram>,
    /// True if delivered tokens are kept.
    keeps_tokens: Cell<bool>,
    /// Delivered tokens since they were last taken, if they are kept.
    kept: RefCell<KeptTokens>,
}

/// Full length of the ring of a FIFO of this depth.
fn full_ring(depth: usize) -> usize {
    (depth + SWEEP).next_power_of_two()
}

impl FifoTiming {
    /// Creates the times of a FIFO in the memory of an earlier run. `awaits`: true if its producer has memory clients, so that each
    /// slot keeps their answers.
    pub(crate) fn new(&FifoSpec { depth, latency, period, .. }: &FifoSpec, awaits: bool, memory: FifoMemory) -> Self {
        let full = full_ring(depth);
        let tokens = full.min(FIRST_RING);
        let FifoMemory { ring, mut kept } = memory;
        kept.visible.clear();
        kept.deliveries.clear();
        Self {
            ring: TokenRing::in_memory(ring, tokens, awaits),
            must_grow: Cell::new(false),
            depth,
            slots_back: if tokens == full { depth } else { 0 },
            pushed: Cell::new(0),
            delivered: Cell::new(0),
            popped: Cell::new(0),
            latency,
            period,
            front: Cell::new(Cycle::UNKNOWN),
            room: Cell::default(),
            next_visible: Cell::default(),
            no_push_before: Cell::default(),
            no_pop_before: Cell::default(),
            news: Default::default(),
            occupancy: OccupancyHistogram::new(depth).into(),
            keeps_tokens: Cell::new(false),
            kept: kept.into(),
        }
    }

    /// Tokens inside, delivered or not.
    #[inline]
    pub(crate) fn len(&self) -> usize {
        self.pushed.get() - self.popped.get()
    }

    /// Returns true if no token is inside.
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

    /// Number of the token whose slot the next token takes.
    #[inline(always)]
    fn slot(&self) -> usize {
        self.pushed.get().wrapping_sub(self.slots_back)
    }

    /// First visible cycle of the front token; unknown while there is none or its delivery is unknown.
    #[inline(always)]
    pub(crate) fn front_visible(&self) -> Cycle {
        self.front.get()
    }

    /// The first cycle in which the next push finds a slot (law 2): the cycle after the pop of token n - depth.
    #[inline(always)]
    pub(crate) fn room_at(&self) -> Cycle {
        self.room.get()
    }

    /// Returns [`FifoTiming::front_visible`], or a lower bound if it is unknown.
    #[inline]
    pub(crate) fn no_front_before(&self) -> Cycle {
        match self.front_visible() {
            Cycle::UNKNOWN if self.popped < self.pushed => self.next_visible.get(),
            Cycle::UNKNOWN => (self.no_push_before.get() + self.latency).max(self.next_visible.get()),
            visible => visible,
        }
    }

    /// Returns [`FifoTiming::room_at`], or a lower bound if it is unknown.
    #[inline]
    pub(crate) fn no_room_before(&self) -> Cycle {
        match self.room_at() {
            Cycle::UNKNOWN => self.no_pop_before.get() + 1,
            room => room,
        }
    }

    /// Promises that the producer makes no step before `start`.
    #[inline]
    pub(crate) fn promise_push(&self, start: Cycle) {
        // While there is a token, the consumer uses that token's time.
        if self.no_push_before.replace(start) != start && self.is_empty() {
            self.news[CONSUMER].set(true);
        }
    }

    /// Promises that the consumer makes no step before `start`.
    #[inline]
    pub(crate) fn promise_pop(&self, start: Cycle) {
        if self.no_pop_before.replace(start) != start && !self.room_at().is_known() {
            self.news[PRODUCER].set(true);
        }
    }

    /// Law 9: the cycle until which the oldest slot holder, which blocks the next push, waits for `client`'s answer. Only
    /// meaningful while the FIFO is full; unknown while the answer is unknown.
    #[inline]
    pub(crate) fn oldest_awaits(&self, client: usize) -> Cycle {
        self.ring.awaits(self.slot()).map_or(Cycle::ZERO, |answers| answers.get()[client])
    }

    /// Tokens popped so far.
    pub(super) fn popped(&self) -> usize {
        self.popped.get()
    }

    /// Records until when the next token to be delivered waits for each client's answer.
    #[inline]
    pub(crate) fn set_awaits(&self, answers: [Cycle; MAX_CLIENTS]) {
        if let Some(awaits) = self.ring.awaits(self.delivered.get()) {
            awaits.set(answers);
        }
    }

    /// Reserves a slot at the start of the step that fills it.
    #[inline(always)]
    pub(crate) fn reserve(&self, start: Cycle) {
        let (ring, number) = (&self.ring, self.pushed.get());
        let new = ring.token(number);
        new.reserved.set(start);
        new.free.set(Cycle::UNKNOWN);
        new.next_visible.set(Cycle::UNKNOWN);
        if let Some(awaits) = ring.awaits(number) {
            awaits.set(Default::default());
        }
        self.pushed.set(number + 1);
        self.room.set(ring.token(self.slot()).free.get());
        if (number + 1).is_multiple_of(SWEEP) {
            self.settle();
        }
    }

    /// Delivers the oldest reserved token (law 1): visible from max(d + f, visible time of the token before it + 1), or from the
    /// next multiple of the period.
    #[inline(always)]
    pub(crate) fn deliver(&self, delivered: Cycle) {
        let mut visible = delivered.after(self.latency).max(self.next_visible.get());
        if self.period > 1 {
            visible = Cycle(visible.0.next_multiple_of(self.period));
        }
        let number = self.delivered.get();
        self.ring.token(number.wrapping_sub(1)).next_visible.set(visible);
        if self.keeps_tokens.get() {
            self.keep(delivered, visible);
        }
        self.next_visible.set(visible.after(1));
        self.delivered.set(number + 1);
        if number == self.popped.get() {
            self.front.set(visible);
            self.news[CONSUMER].set(true);
        }
    }

    /// Keeps the token that is being delivered. (Within `deliver` this code costs a tenth of a step, although it never runs.)
    #[cold]
    #[inline(never)]
    fn keep(&self, delivered: Cycle, visible: Cycle) {
        let mut kept = self.kept.borrow_mut();
        kept.visible.push(visible);
        let Some(answers) = self.ring.awaits(self.delivered.get()).map(Cell::get) else { return };
        let last = (1..MAX_CLIENTS).fold(0, |last, client| if answers[client] > answers[last] { client } else { last });
        kept.deliveries.push(AnsweredDelivery { at: delivered, last_client: last as u8 });
    }

    /// Pops the front token.
    #[inline(always)]
    pub(crate) fn pop(&self, at: Cycle) {
        let (number, free) = (self.popped.get(), at.after(1));
        let token = self.ring.token(number);
        token.free.set(free);
        self.popped.set(number + 1);
        self.front.set(token.next_visible.get());
        if number + self.depth == self.pushed.get() {
            self.room.set(free);
            self.news[PRODUCER].set(true);
        }
    }

    /// Returns true if there is news for the consumer since the last call.
    #[inline(always)]
    pub(super) fn has_news_for_consumer(&self) -> bool {
        self.news[CONSUMER].take()
    }

    /// Returns true if there is news for the producer since the last call.
    #[inline(always)]
    pub(super) fn has_news_for_producer(&self) -> bool {
        self.news[PRODUCER].take()
    }

    /// Settles the occupancy. If the ring has no room for the tokens up to the next settlement, no push is possible until it has
    /// [grown](FifoTiming::grow).
    #[inline(never)]
    fn settle(&self) {
        self.occupancy.borrow_mut().settle(&self.ring, self.pushed.get(), self.popped.get());
        if self.slots_back == 0 && !self.has_room_for_sweep() {
            self.must_grow.set(true);
            self.room.set(Cycle::UNKNOWN);
        }
    }

    /// Returns true if the tokens up to the next settlement may take the entries of earlier tokens, or entries that were never used.
    ///
    /// Neither must a push up to then wait for a slot. A token may be forgotten if it left its slot by now: its occupancy is settled
    /// then, and no later push waits for it, because each reserves its own slot later.
    fn has_room_for_sweep(&self) -> bool {
        let kept = self.ring.len().min(self.depth);
        let Some(last) = (self.pushed.get() + SWEEP).checked_sub(kept + 1) else { return true };
        let now = self.ring.token(self.pushed.get().wrapping_sub(1)).reserved.get();
        self.ring.token(last).free.get() <= now
    }

    /// Returns true if no push is possible until the ring has [grown](FifoTiming::grow). Its producer asks after each visit.
    #[inline(always)]
    pub(crate) fn must_grow(&self) -> bool {
        self.must_grow.get()
    }

    /// Doubles the ring if it must grow. Then pushes are possible again.
    #[inline]
    pub(crate) fn grow(&mut self) {
        if self.must_grow() {
            self.double();
        }
    }

    #[cold]
    fn double(&mut self) {
        self.must_grow.set(false);
        self.ring.double(self.pushed.get());
        if self.ring.len() == full_ring(self.depth) {
            self.slots_back = self.depth;
        }
        self.room.set(self.ring.token(self.slot()).free.get());
    }

    /// Returns the memory of its times, for the next run.
    pub(super) fn into_memory(self) -> FifoMemory {
        FifoMemory { ring: self.ring, kept: self.kept.into_inner() }
    }
}
