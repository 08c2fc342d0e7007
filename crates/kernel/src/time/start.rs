//! When the next step of a stage can start, and why not before (laws 3 and 9).

use super::clock::Wait;
use super::{Clock, Known, Slots, Time};
use crate::{Cause, Cycle, Demand, MemorySystem};

impl Time {
    /// The earliest start of a stage's next step (law 3); unknown while that depends on what is not known yet, and where it will make
    /// no further step.
    #[inline(always)]
    pub(crate) fn next_start<K: Known>(&self, stage: usize, demand: Demand) -> Cycle {
        let Self { stages, fifos, memories, .. } = self;
        let clock = &stages[stage];
        if demand == Demand::Finished {
            return Cycle::UNKNOWN;
        }
        let mut at = clock.free;
        let inputs = demand.of(clock.inputs.count(K::INPUTS));
        clock.inputs.each(inputs, K::INPUTS, |fifo| at = at.max(fifos[fifo].front_visible()));
        // Most visits end here: what else is unknown makes no difference.
        if !at.is_known() {
            return at;
        }
        clock.outputs.each(clock.outputs.all(), K::OUTPUTS, |fifo| at = at.max(fifos[fifo].room_at()));
        if K::HAS_MEMORY {
            for (&client, &credits) in clock.clients.iter().zip(&clock.needs.credits) {
                at = at.max(memories.credits_at(client, credits));
            }
        }
        at
    }

    /// Promises that a stage makes no step before it can at the earliest: with what its neighbours have promised, where they
    /// have not come so far yet. Its neighbours build on that in turn, and its memories serve what others asked for until
    /// then.
    #[inline(always)]
    pub(crate) fn promise<K: Known>(&mut self, stage: usize, demand: Demand) -> Cycle {
        let Self { stages, fifos, memories, .. } = self;
        let clock = &stages[stage];
        let mut start = if demand == Demand::Finished { Cycle::UNKNOWN } else { clock.free };
        let inputs = demand.of(clock.inputs.count(K::INPUTS));
        let (all, room) = (clock.inputs.all(), clock.outputs.all());
        clock.inputs.each(inputs, K::INPUTS, |fifo| start = start.max(fifos[fifo].no_front_before()));
        clock.outputs.each(room, K::OUTPUTS, |fifo| start = start.max(fifos[fifo].no_room_before()));
        clock.inputs.each(all, K::INPUTS, |fifo| fifos[fifo].promise_pop(start));
        clock.outputs.each(room, K::OUTPUTS, |fifo| fifos[fifo].promise_push(start));
        if K::HAS_MEMORY {
            clock.clients.iter().for_each(|&client| memories.promise(client, start));
        }
        start
    }

    /// Serves what is final of the memories that no other stage uses, when this one makes no step before `horizon`; whether
    /// there was any.
    #[inline(always)]
    pub(crate) fn serve_private<K: Known>(&mut self, stage: usize, horizon: Cycle) -> bool {
        let Self { stages, memories, .. } = self;
        K::HAS_MEMORY && stages[stage].clients.iter().fold(false, |any, &client| memories.serve_if_private(client, horizon) | any)
    }

    /// Splits the wait of a stage from `from` to `to` into its causes (law 9), in order, and hands each to `charge`.
    pub(crate) fn split_wait(&self, stage: usize, demand: Demand, between: (Cycle, Cycle), charge: impl FnMut(Wait)) {
        self.stages[stage].split_wait(&self.fifos, &self.memories, demand, between, charge);
    }
}

impl Clock {
    /// See [`Time::split_wait`].
    ///
    /// In each cycle the first cause that applies counts; every condition, once met, stays met until the step starts. So
    /// the causes follow each other in the order in which they are tried, and a running maximum splits the interval.
    #[inline]
    pub(super) fn split_wait(
        &self,
        fifos: &[Slots],
        memories: &MemorySystem,
        demand: Demand,
        (from, to): (Cycle, Cycle),
        mut charge: impl FnMut(Wait),
    ) {
        let mut at = from;
        // Tells whether nothing of the interval is left.
        let mut until = |cause: Cause, end: Cycle| {
            let end = end.min(to);
            if end > at {
                charge((cause, at, end));
                at = end;
            }
            at >= to
        };
        for (i, fifo) in self.inputs.of(demand.of(self.inputs.count(None))) {
            if until(Cause::Starved(i), fifos[fifo].front_visible()) {
                return;
            }
        }
        for (i, (&client, &credits)) in self.clients.iter().zip(&self.needs.credits).enumerate() {
            if until(Cause::Memory(i), memories.credits_at(client, credits)) {
                return;
            }
        }
        for (i, fifo) in self.outputs.of(self.outputs.all()) {
            let room = fifos[fifo].room_at();
            for &client in self.needs.served_in_order.iter().take(self.clients.len()) {
                until(Cause::Memory(client), fifos[fifo].oldest_awaits(client).min(room));
            }
            until(Cause::Blocked(i), room);
        }
    }
}
