//! Occupancy of a FIFO (law 10): slots reserved or filled, from reservation through pop.

use super::token_ring::{TokenRing, TokenTimes};
use crate::Cycle;
use crate::memory_events::{EventBounds, Gauge};

/// Histogram of one FIFO's occupancy.
///
/// Pushes and pops are each monotone, so all events up to min(last push, last pop) are settled: no later event can be earlier. At
/// most one ring of pushes remains unsettled.
#[derive(Clone, Debug)]
pub(crate) struct OccupancyHistogram {
    histogram: Vec<u64>,
    /// Numbers of the first unsettled push and pop.
    push: usize,
    pop: usize,
    held: usize,
    settled_to: Cycle,
    /// The ticked engine counts literally: slots in use in the last counted cycle, and that cycle.
    counted: Option<(usize, Cycle)>,
    /// True if occupancy is not counted.
    is_off: bool,
    /// Changes since they were last taken, if a probe is attached.
    fills: Option<LevelHistory>,
}

/// Levels of a FIFO, in order of time, and its visible tokens.
#[derive(Clone, Debug, Default)]
struct LevelHistory {
    new: Vec<(Cycle, usize)>,
    last: usize,
    /// `None` if nobody reads them.
    visible: Option<Gauge>,
}

impl LevelHistory {
    /// Records a push, or a pop whose slot is free from `at` on.
    fn change(&mut self, at: Cycle, held: usize, is_pop: bool) {
        self.hold(at, held);
        if is_pop {
            self.pop_visible(at);
        }
    }

    /// Records that a token is visible before `at` only.
    fn pop_visible(&mut self, at: Cycle) {
        if let Some(visible) = &mut self.visible {
            visible.down(at);
        }
    }

    /// Sets the level from a cycle on, unless another change comes in the same cycle.
    fn hold(&mut self, at: Cycle, held: usize) {
        match self.new.last_mut() {
            Some(last) if last.0 == at => last.1 = held,
            _ => self.new.push((at, held)),
        }
    }

    /// Takes the changes before a cycle. Those in the cycle itself may still change.
    fn take_before(&mut self, until: Cycle) -> Vec<(Cycle, usize)> {
        let settled = self.new.partition_point(|(at, _)| *at < until);
        let last = &mut self.last;
        self.new.drain(..settled).filter(|(_, held)| std::mem::replace(last, *held) != *held).collect()
    }
}

impl OccupancyHistogram {
    pub(crate) fn new(depth: usize) -> Self {
        Self {
            histogram: vec![0; depth + 1],
            push: 0,
            pop: 0,
            held: 0,
            settled_to: Cycle::ZERO,
            counted: None,
            is_off: false,
            fills: None,
        }
    }

    /// Switches counting off.
    pub(crate) fn count_nothing(&mut self) {
        self.is_off = true;
    }

    /// Records changes of the level, and of the number of visible tokens if `visible`.
    pub(crate) fn keep_fills(&mut self, visible: bool) {
        self.fills = Some(LevelHistory { visible: visible.then(Gauge::default), ..LevelHistory::default() });
    }

    /// Takes the changes of the level since the last call, as far as they are settled, or up to `end`.
    pub(crate) fn take_fills(&mut self, end: Option<Cycle>) -> Vec<(Cycle, usize)> {
        let until = end.unwrap_or(self.counted.map_or(self.settled_to, |(_, last)| last));
        self.fills.as_mut().map_or_else(Vec::new, |fills| fills.take_before(until))
    }

    /// Emits changes of the number of visible tokens. `visible`: first visible cycles of the tokens since the last call.
    pub(crate) fn emit_visible(&mut self, visible: &[Cycle], bounds: EventBounds, emit: impl FnMut(Cycle, usize)) {
        if let Some(LevelHistory { visible: Some(tokens), .. }) = &mut self.fills {
            visible.iter().for_each(|at| tokens.up(*at));
            tokens.emit(bounds, emit);
        }
    }

    fn advance(&mut self, to: Cycle) {
        self.histogram[self.held] += to.since(self.settled_to);
        self.settled_to = self.settled_to.max(to);
    }

    /// Settles all events that can be settled. `pushed`, `popped`: numbers of tokens.
    pub(crate) fn settle(&mut self, ring: &TokenRing, pushed: usize, popped: usize) {
        if self.counted.is_some() || self.is_off {
            return;
        }
        match self.fills.take() {
            // A separate case: checking for a probe at each event costs a tenth of a bare chain.
            None => self.merge(ring, pushed, popped, |_, _, _| ()),
            Some(mut fills) => {
                self.merge(ring, pushed, popped, |at, held, is_pop| fills.change(at, held, is_pop));
                self.fills = Some(fills);
            }
        }
    }

    #[inline(always)]
    fn merge(&mut self, ring: &TokenRing, pushed: usize, popped: usize, mut hold: impl FnMut(Cycle, usize, bool)) {
        while self.push < pushed && self.pop < popped {
            self.merge_runs(ring.run(self.push, pushed), ring.run(self.pop, popped), &mut hold);
        }
    }

    /// Settles the events of two runs in order of time, until one of them ends.
    #[inline(always)]
    fn merge_runs(&mut self, pushes: &[TokenTimes], pops: &[TokenTimes], hold: &mut impl FnMut(Cycle, usize, bool)) {
        let mut next_pushes = pushes.iter().map(|token| token.reserved.get());
        let mut next_pops = pops.iter().map(|token| token.free.get());
        let (Some(mut push), Some(mut pop)) = (next_pushes.next(), next_pops.next()) else { return };
        let (mut held, mut now) = (self.held, self.settled_to);
        let mut change = |to: Cycle, by: isize| {
            self.histogram[held] += to.0 - now.0;
            now = to;
            held = held.wrapping_add_signed(by);
            hold(to, held, by < 0);
        };
        // In one cycle a slot may be freed and another reserved; the level in between lasts 0 cycles. The free slot counts first,
        // because it is in use until the end of the cycle, so the level never exceeds the depth. Usually pushes and pops
        // alternate, which a branch predictor foresees. Without a branch every event would wait for the previous times.
        let unsettled = 'events: loop {
            while push < pop {
                change(push, 1);
                let Some(next) = next_pushes.next() else { break 'events [0, 1] };
                push = next;
            }
            while pop <= push {
                change(pop, -1);
                let Some(next) = next_pops.next() else { break 'events [1, 0] };
                pop = next;
            }
        };
        (self.held, self.settled_to) = (held, now);
        self.push += pushes.len() - next_pushes.len() - unsettled[0];
        self.pop += pops.len() - next_pops.len() - unsettled[1];
    }

    /// Settles the rest of a run of `total` cycles.
    pub(crate) fn finish(&mut self, ring: &TokenRing, pushed: usize, popped: usize, total: Cycle) -> Vec<u64> {
        if let Some((held, last)) = self.counted {
            // The ticked engine detects the end of a run one cycle late.
            self.histogram[held] -= (last + 1).since(total);
            return self.histogram.clone();
        }
        if self.is_off {
            return vec![];
        }
        self.settle(ring, pushed, popped);
        for push in self.push..pushed {
            let at = ring.token(push).reserved.get();
            self.advance(at);
            self.held += 1;
            self.change(at, false);
        }
        for pop in self.pop..popped {
            let at = ring.token(pop).free.get();
            self.advance(at.min(total));
            self.held -= 1;
            self.change(at, true);
        }
        (self.push, self.pop) = (pushed, popped);
        self.advance(total);
        self.histogram.clone()
    }

    fn change(&mut self, at: Cycle, is_pop: bool) {
        if let Some(fills) = &mut self.fills {
            fills.change(at, self.held, is_pop);
        }
    }

    /// Counts one cycle. `pops`: true if a token is popped in it.
    pub(crate) fn count(&mut self, held: usize, pops: bool, now: Cycle) {
        self.histogram[held] += 1;
        if let Some(fills) = &mut self.fills {
            fills.hold(now, held);
            if pops {
                fills.pop_visible(now + 1);
            }
        }
        self.counted = Some((held, now));
    }
}
