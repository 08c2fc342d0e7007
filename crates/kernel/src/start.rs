//! When the next step of a stage can start, and why not before (laws 3 and 9).

use crate::connections::{Clients, Connections};
use crate::stage::{Clock, Needs, Start, Wait};
use crate::wiring::{Inputs, Outputs};
use crate::{Cause, Cycle, Demand, Unit};

impl<I: Inputs, O: Outputs, C: Clients> Connections<I, O, C> {
    /// The earliest start of the unit's next step (law 3); `None` if it will make no further step.
    ///
    /// What runs in every step is marked to be inlined always: a step is a dozen comparisons, and left to itself the compiler
    /// inlines them or not as it happens to divide the crates into units of code.
    #[inline(always)]
    pub(crate) fn next_start(&self, unit: &impl Unit, clock: &Clock) -> Option<Start> {
        let Self { inputs, outputs, clients } = self;
        let demand = unit.demand();
        if demand == Demand::Finished {
            return None;
        }
        let mut at = clock.free;
        for i in (0..inputs.count()).filter(|&i| demand.takes(i)) {
            at = at.max(inputs.link(i).front_visible());
        }
        // Most visits end here: what else is unknown makes no difference.
        if !at.is_known() {
            return Some(Start { at, demand });
        }
        for i in 0..outputs.count() {
            at = at.max(outputs.link(i).room_at());
        }
        if let Some(memories) = clients.memories() {
            for (&client, &credits) in clients.ids().iter().zip(&clock.needs.credits) {
                at = at.max(memories.credits_at(client, credits));
            }
        }
        Some(Start { at, demand })
    }

    /// Promises that the unit makes no step before it can at the earliest: with what its neighbours have promised, where they
    /// have not come so far yet. Its neighbours build on that in turn, and its memories serve what others asked for until
    /// then.
    #[inline(always)]
    pub(crate) fn promise(&mut self, demand: Demand, free: Cycle) -> Cycle {
        let Self { inputs, outputs, clients } = self;
        let mut start = if demand == Demand::Finished { Cycle::UNKNOWN } else { free };
        for i in (0..inputs.count()).filter(|&i| demand.takes(i)) {
            start = start.max(inputs.link(i).no_front_before());
        }
        for i in 0..outputs.count() {
            start = start.max(outputs.link(i).no_room_before());
        }
        for i in 0..inputs.count() {
            inputs.link_mut(i).promise_pop(start);
        }
        for i in 0..outputs.count() {
            outputs.link_mut(i).promise_push(start);
        }
        if let Some((ids, memories)) = clients.open() {
            ids.iter().for_each(|&client| memories.promise(client, start));
        }
        start
    }

    /// Serves what is final of the memories that no other stage uses, when this one makes no step before `horizon`; whether
    /// there was any.
    #[inline(always)]
    pub(crate) fn serve_private(&mut self, horizon: Cycle) -> bool {
        let Some((ids, memories)) = self.clients.open() else { return false };
        ids.iter().fold(false, |any, &client| memories.serve_if_private(client, horizon) | any)
    }

    /// Splits the wait from `from` to `to` into its causes (law 9), in order, and hands each to `charge`.
    ///
    /// In each cycle the first cause that applies counts; every condition, once met, stays met until the step starts. So
    /// the causes follow each other in the order in which they are tried, and a running maximum splits the interval.
    pub(crate) fn split_wait(&self, needs: &Needs, demand: Demand, (from, to): (Cycle, Cycle), mut charge: impl FnMut(Wait)) {
        let Self { inputs, outputs, clients } = self;
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
        for i in (0..inputs.count()).filter(|&i| demand.takes(i)) {
            if until(Cause::Starved(i), inputs.link(i).front_visible()) {
                return;
            }
        }
        if let Some(memories) = clients.memories() {
            for (i, (&client, &credits)) in clients.ids().iter().zip(&needs.credits).enumerate() {
                if until(Cause::Memory(i), memories.credits_at(client, credits)) {
                    return;
                }
            }
        }
        for i in 0..outputs.count() {
            let link = outputs.link(i);
            let room = link.room_at();
            for &client in needs.served_in_order.iter().take(clients.ids().len()) {
                until(Cause::Memory(client), link.oldest_awaits(client).min(room));
            }
            until(Cause::Blocked(i), room);
        }
    }
}
