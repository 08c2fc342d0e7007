//! When the next step of a stage can start, and why not before (laws 3 and 9).

use super::clock::Wait;
use super::ends::Joined;
use super::{Clock, Known, Time, Unknown};
use crate::{Cause, Cycle, Demand, MemorySystem};

impl Time {
    /// See [`Clock::next_start`].
    pub(crate) fn next_start(&self, stage: usize, demand: Demand) -> Cycle {
        let clock = &self.stages[stage];
        let [inputs, outputs] = [clock.inputs, clock.outputs].map(|ends| ends.join(&self.fifos, None));
        clock.next_start::<Unknown>((&inputs, &outputs), &self.memories, demand)
    }

    /// Splits the wait of a stage from `from` to `to` into its causes (law 9), in order, and hands each to `charge`.
    pub(crate) fn split_wait(&self, stage: usize, demand: Demand, between: (Cycle, Cycle), charge: impl FnMut(Wait)) {
        let clock = &self.stages[stage];
        let [inputs, outputs] = [clock.inputs, clock.outputs].map(|ends| ends.join(&self.fifos, None));
        clock.split_wait::<Unknown>((&inputs, &outputs), &self.memories, demand, between, charge);
    }
}

impl Clock {
    /// The earliest start of a stage's next step (law 3); unknown while that depends on what is not known yet, and where it will make
    /// no further step.
    #[inline(always)]
    pub(super) fn next_start<K: Known>(
        &self,
        (inputs, outputs): (&Joined<'_>, &Joined<'_>),
        memories: &MemorySystem,
        demand: Demand,
    ) -> Cycle {
        if demand == Demand::Finished {
            return Cycle::UNKNOWN;
        }
        let mut at = self.free;
        inputs.each(demand.of(inputs.count(K::INPUTS)), K::INPUTS, |_, fifo| at = at.max(fifo.front_visible()));
        // Most visits end here: what else is unknown makes no difference.
        if !at.is_known() {
            return at;
        }
        outputs.each(outputs.all(K::OUTPUTS), K::OUTPUTS, |_, fifo| at = at.max(fifo.room_at()));
        if K::HAS_MEMORY && self.needs.asked {
            for (&client, &credits) in self.clients.iter().zip(&self.needs.credits) {
                at = at.max(memories.credits_at(client, credits));
            }
        }
        at
    }

    /// See [`Time::split_wait`].
    ///
    /// In each cycle the first cause that applies counts; every condition, once met, stays met until the step starts. So
    /// the causes follow each other in the order in which they are tried, and a running maximum splits the interval.
    #[inline(always)]
    pub(super) fn split_wait<K: Known>(
        &self,
        (inputs, outputs): (&Joined<'_>, &Joined<'_>),
        memories: &MemorySystem,
        demand: Demand,
        (from, to): (Cycle, Cycle),
        mut charge: impl FnMut(Wait),
    ) {
        let mut at = from;
        let mut until = |cause: Cause, end: Cycle| {
            let end = end.min(to);
            if end > at {
                charge((cause, at, end));
                at = end;
            }
            // Whether nothing of the interval is left.
            at >= to
        };
        let mut over = false;
        inputs.each(demand.of(inputs.count(K::INPUTS)), K::INPUTS, |i, fifo| {
            over = until(Cause::Starved(i), fifo.front_visible());
        });
        if over {
            return;
        }
        if K::HAS_MEMORY && self.needs.asked {
            for (i, (&client, &credits)) in self.clients.iter().zip(&self.needs.credits).enumerate() {
                if until(Cause::Memory(i), memories.credits_at(client, credits)) {
                    return;
                }
            }
        }
        outputs.each(outputs.all(K::OUTPUTS), K::OUTPUTS, |i, fifo| {
            let room = fifo.room_at();
            if K::HAS_MEMORY {
                for &client in self.needs.served_in_order.iter().take(self.clients.len()) {
                    until(Cause::Memory(client), fifo.oldest_awaits(client).min(room));
                }
            }
            until(Cause::Blocked(i), room);
        });
    }
}
