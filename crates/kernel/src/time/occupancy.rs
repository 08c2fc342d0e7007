//! Occupancy of a FIFO (law 10): slots reserved or filled, from reservation through pop.

use super::token_times::TokenTimes;
use crate::Cycle;

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
    /// Changes of the level since they were last taken, if a probe is attached.
    fills: Option<LevelHistory>,
}

/// Levels of a FIFO, in order of time.
#[derive(Clone, Debug, Default)]
struct LevelHistory {
    new: Vec<(Cycle, usize)>,
    last: usize,
}

impl LevelHistory {
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

    /// Records changes of the level.
    pub(crate) fn keep_fills(&mut self) {
        self.fills = Some(LevelHistory::default());
    }

    /// Takes the changes of the level since the last call, as far as they are settled, or up to `end`.
    pub(crate) fn take_fills(&mut self, end: Option<Cycle>) -> Vec<(Cycle, usize)> {
        let until = end.unwrap_or(self.counted.map_or(self.settled_to, |(_, last)| last));
        self.fills.as_mut().map_or_else(Vec::new, |fills| fills.take_before(until))
    }

    fn advance(&mut self, to: Cycle) {
        self.histogram[self.held] += to.since(self.settled_to);
        self.settled_to = self.settled_to.max(to);
    }

    /// Settles all events that can be settled. `pushed`, `popped`: numbers of tokens.
    pub(crate) fn settle(&mut self, ring: &[TokenTimes], pushed: usize, popped: usize) {
        if self.counted.is_some() || self.is_off {
            return;
        }
        match self.fills.take() {
            // A separate case: checking for a probe at each event costs a tenth of a bare chain.
            None => self.merge(ring, pushed, popped, |_, _| ()),
            Some(mut fills) => {
                self.merge(ring, pushed, popped, |at, held| fills.hold(at, held));
                self.fills = Some(fills);
            }
        }
    }

    #[inline(always)]
    fn merge(&mut self, ring: &[TokenTimes], pushed: usize, popped: usize, mut hold: impl FnMut(Cycle, usize)) {
        let mask = ring.len() - 1;
        let (mut push, mut pop, mut held, mut now) = (self.push, self.pop, self.held, self.settled_to);
        let mut change = |to: Cycle, by: isize| {
            self.histogram[held] += to.0 - now.0;
            now = to;
            held = held.wrapping_add_signed(by);
            hold(to, held);
        };
        // In one cycle a slot may be freed and another reserved; the level in between lasts 0 cycles. The free slot counts first,
        // because it is in use until the end of the cycle, so the level never exceeds the depth. Usually pushes and pops
        // alternate, which a branch predictor foresees. Without a branch every event would wait for the previous times.
        while push < pushed && pop < popped {
            let free = ring[pop & mask].free.get();
            while push < pushed && ring[push & mask].reserved.get() < free {
                change(ring[push & mask].reserved.get(), 1);
                push += 1;
            }
            if push == pushed {
                break;
            }
            let reserved = ring[push & mask].reserved.get();
            while pop < popped && ring[pop & mask].free.get() <= reserved {
                change(ring[pop & mask].free.get(), -1);
                pop += 1;
            }
        }
        (self.push, self.pop, self.held, self.settled_to) = (push, pop, held, now);
    }

    /// Settles the rest of a run of `total` cycles.
    pub(crate) fn finish(&mut self, ring: &[TokenTimes], pushed: usize, popped: usize, total: Cycle) -> Vec<u64> {
        if let Some((held, last)) = self.counted {
            // The ticked engine detects the end of a run one cycle late.
            self.histogram[held] -= (last + 1).since(total);
            return self.histogram.clone();
        }
        if self.is_off {
            return vec![];
        }
        self.settle(ring, pushed, popped);
        let token = |number: usize| &ring[number & (ring.len() - 1)];
        for push in self.push..pushed {
            let at = token(push).reserved.get();
            self.advance(at);
            self.held += 1;
            self.hold(at);
        }
        for pop in self.pop..popped {
            let at = token(pop).free.get();
            self.advance(at.min(total));
            self.held -= 1;
            self.hold(at);
        }
        (self.push, self.pop) = (pushed, popped);
        self.advance(total);
        self.histogram.clone()
    }

    fn hold(&mut self, at: Cycle) {
        if let Some(fills) = &mut self.fills {
            fills.hold(at, self.held);
        }
    }

    /// Counts one cycle.
    pub(crate) fn count(&mut self, held: usize, now: Cycle) {
        self.histogram[held] += 1;
        if let Some(fills) = &mut self.fills {
            fills.hold(now, held);
        }
        self.counted = Some((held, now));
    }
}
