//! Occupancy of a FIFO (law 10): slots reserved or filled, from reservation through pop.

use super::token_times::TokenTimes;
use crate::Cycle;

/// The histogram of one FIFO's occupancy.
///
/// Pushes and pops are each monotone, so all events up to min(last push, last pop) are settled: no event still to come
/// can be earlier. What is left over is at most one ring of pushes.
#[derive(Clone, Debug)]
pub(crate) struct OccupancyHistogram {
    histogram: Vec<u64>,
    /// Numbers of the first push and the first pop that are not settled.
    push: usize,
    pop: usize,
    held: usize,
    settled_to: Cycle,
    /// The ticked engine counts literally: slots held in the last cycle counted, and that cycle.
    counted: Option<(usize, Cycle)>,
    /// Nobody asks for it.
    is_off: bool,
    /// What it held from when on, wherever that changed, where somebody looks on: since it was last taken.
    fills: Option<LevelHistory>,
}

/// How full a FIFO was, in order of time.
#[derive(Clone, Debug, Default)]
struct LevelHistory {
    new: Vec<(Cycle, usize)>,
    last: usize,
}

impl LevelHistory {
    /// It holds so many from a cycle on, unless something else comes in the same cycle.
    fn hold(&mut self, at: Cycle, held: usize) {
        match self.new.last_mut() {
            Some(last) if last.0 == at => last.1 = held,
            _ => self.new.push((at, held)),
        }
    }

    /// Those before a cycle: what comes there may still change.
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

    /// Counts nothing from now on.
    pub(crate) fn count_nothing(&mut self) {
        self.is_off = true;
    }

    /// Keeps what it holds, to be taken.
    pub(crate) fn keep_fills(&mut self) {
        self.fills = Some(LevelHistory::default());
    }

    /// How many slots it held from when on, wherever that changed, since the last call: as far as that is settled, or up to `end`.
    pub(crate) fn take_fills(&mut self, end: Option<Cycle>) -> Vec<(Cycle, usize)> {
        let until = end.unwrap_or(self.counted.map_or(self.settled_to, |(_, last)| last));
        self.fills.as_mut().map_or_else(Vec::new, |fills| fills.take_before(until))
    }

    fn advance(&mut self, to: Cycle) {
        self.histogram[self.held] += to.since(self.settled_to);
        self.settled_to = self.settled_to.max(to);
    }

    /// Settles what can be settled, and keeps the rest: so many tokens are pushed, and so many popped.
    pub(crate) fn settle(&mut self, ring: &[TokenTimes], ends: (usize, usize)) {
        if self.counted.is_some() || self.is_off {
            return;
        }
        match self.fills.take() {
            // By itself: asking at each event whether somebody looks on costs a tenth of a bare chain.
            None => self.merge(ring, ends, |_, _| ()),
            Some(mut fills) => {
                self.merge(ring, ends, |at, held| fills.hold(at, held));
                self.fills = Some(fills);
            }
        }
    }

    #[inline(always)]
    fn merge(&mut self, ring: &[TokenTimes], (pushed, popped): (usize, usize), mut hold: impl FnMut(Cycle, usize)) {
        let mask = ring.len() - 1;
        let (mut push, mut pop, mut held, mut now) = (self.push, self.pop, self.held, self.settled_to);
        let mut change = |to: Cycle, by: isize| {
            self.histogram[held] += to.0 - now.0;
            now = to;
            held = held.wrapping_add_signed(by);
            hold(to, held);
        };
        // In one cycle a slot may be freed and another reserved; the count in between lasts 0 cycles. Freed first, as it is held to
        // its end: so it never seems to hold more than there are. Mostly they take turns, which a processor foresees; without a branch
        // every event would wait for the times of the last.
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
    pub(crate) fn finish(&mut self, ring: &[TokenTimes], (pushed, popped): (usize, usize), total: Cycle) -> Vec<u64> {
        if let Some((held, last)) = self.counted {
            // The ticked engine learns that a run is over one cycle late.
            self.histogram[held] -= (last + 1).since(total);
            return self.histogram.clone();
        }
        if self.is_off {
            return vec![];
        }
        self.settle(ring, (pushed, popped));
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
