//! Steps in flight: steps that wait for memory answers, or behind such a step (laws 4 and 5).

use super::blocking_wait::ClientOrder;
use crate::capacity::{MAX_CLIENTS, MAX_LINKS};
use crate::memory_system::LookUpQueue;
use crate::step_requests::{CacheLookUps, StepRequestsView};
use crate::{Cycle, MemoryClients, MemorySystem, Request};
use std::collections::VecDeque;

/// A step's delivery, as far as it does not depend on memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Delivery {
    /// Start + latency: the earliest delivery.
    pub(crate) base: Cycle,
    /// Cycles from the last answer to the delivery, at least; 0 if it waits for no answer.
    pub(crate) after_data: u32,
    /// Outputs that get a token, one bit each, and the bits [`MARKED`] and [`BLOCKING`].
    pub(crate) outputs: u32,
}

/// Bit of [`Delivery::outputs`]: the delivery passes a mark.
pub(crate) const MARKED: u32 = 1 << MAX_LINKS;
/// Bit of [`Delivery::outputs`]: the last answer frees the unit.
pub(crate) const BLOCKING: u32 = MARKED << 1;

/// A step that has issued its requests.
#[derive(Clone, Debug)]
pub(crate) struct InFlightStep {
    pub(crate) delivery: Delivery,
    /// Number of the step.
    pub(crate) step: u64,
    /// Steps with unanswered look-ups, by client: the step itself, and steps merged into it.
    look_ups: [u32; MAX_CLIENTS],
    /// Number of the last read plus one, by client; 0 for none, or once its answer is known.
    reads: [u64; MAX_CLIENTS],
    /// Latest known answers.
    pub(crate) answers: [Cycle; MAX_CLIENTS],
    /// Requests served at its issue, by client: it waits for none before.
    served: [u64; MAX_CLIENTS],
}

impl InFlightStep {
    /// Creates a step without requests.
    #[inline]
    pub(crate) fn new(step: u64, delivery: Delivery) -> Self {
        let (look_ups, reads, answers, served) = Default::default();
        Self { delivery, step, look_ups, reads, answers, served }
    }

    /// Delivery time, if all answers are known.
    #[inline]
    pub(crate) fn delivered(&self) -> Cycle {
        let Delivery { base, after_data, .. } = self.delivery;
        let last = self.answers.iter().fold(Cycle::ZERO, |latest, answer| latest.max(*answer));
        base.max(last.after(after_data.into()))
    }

    /// Returns true if the last answer of this step frees the unit.
    pub(crate) fn is_blocking(&self) -> bool {
        self.delivery.outputs & BLOCKING != 0
    }

    /// Takes in the answers to reads. Returns true if all answers are known.
    #[inline(always)]
    fn is_answered(&mut self, clients: &MemoryClients<'_>) -> bool {
        for ((&client, reads), last) in clients.ids.iter().zip(&mut self.reads).zip(&mut self.answers) {
            if let Some(number) = reads.checked_sub(1) {
                let answer = clients.memories.answer(client, number);
                if !answer.is_known() {
                    return false;
                }
                *last = answer.max(*last);
                *reads = 0;
            }
        }
        self.look_ups == [0; MAX_CLIENTS]
    }

    /// Cycle until which it waits for each client's answers, as far as it is known.
    pub(crate) fn awaited(&self, ids: &[usize], system: &MemorySystem) -> [Cycle; MAX_CLIENTS] {
        let mut awaited = self.answers;
        for (i, &client) in ids.iter().enumerate() {
            let read = self.reads[i].checked_sub(1).map_or(Cycle::ZERO, |number| system.answer(client, number));
            let look_up = if self.look_ups[i] > 0 { Cycle::UNKNOWN } else { Cycle::ZERO };
            awaited[i] = awaited[i].max(read).max(look_up);
        }
        awaited
    }
}

/// A step that has just issued its requests.
pub(crate) struct IssuedRequests {
    /// The least occupancy that its requests and look-ups need (laws 4 and 5).
    pub(crate) least: u64,
    /// True if it can deliver at once, because all its answers are known and no step is ahead.
    pub(crate) at_once: bool,
    /// True if it awaits any answer.
    pub(crate) awaits: bool,
    /// Its awaited clients, if it is a blocking step.
    pub(crate) order: ClientOrder,
}

/// Steps in flight, oldest first.
#[derive(Clone, Debug, Default)]
pub(crate) struct InFlightSteps {
    steps: VecDeque<InFlightStep>,
    /// Their unanswered look-ups, by client, in order.
    look_ups: [LookUpQueue; MAX_CLIENTS],
    /// Number of known answers at the last check. Until there are more, no step has become complete.
    asked_at: Option<u64>,
}

impl InFlightSteps {
    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// Makes the look-ups of a step that starts at `start`, if it asks for nothing else, all hit in one cache, and no step is ahead.
    /// Returns the least occupancy that they need. (Such a step needs no place among the steps in flight, and later steps need no new
    /// credits.)
    #[inline]
    pub(crate) fn hit(
        &self,
        flight: &mut InFlightStep,
        start: Cycle,
        clients: &mut MemoryClients<'_>,
        asks: StepRequestsView<'_>,
    ) -> Option<u64> {
        let ([look_ups], [], true) = (asks.look_ups, asks.requests, self.is_empty()) else { return None };
        let own = look_ups.client as usize;
        let (answer, least) = clients.memories.hit(clients.ids[own], start, look_ups)?;
        flight.answers[own] = answer;
        Some(least)
    }

    /// Issues the requests of a step that starts at `start`.
    #[inline]
    pub(crate) fn issue(
        &mut self,
        flight: &mut InFlightStep,
        start: Cycle,
        clients: &mut MemoryClients<'_>,
        asks: StepRequestsView<'_>,
    ) -> IssuedRequests {
        let mut issued = IssuedRequests { least: 1, at_once: false, awaits: false, order: ClientOrder::default() };
        let mut waits = false;
        let is_blocking = flight.is_blocking();
        for look_ups in asks.look_ups {
            let (cycles, waits_too) = self.look_up(flight, start, clients, look_ups, &asks);
            issued.least = issued.least.max(cycles);
            issued.awaits = true;
            waits |= waits_too;
            if is_blocking {
                issued.order.mention(look_ups.client as usize);
            }
        }
        waits |= issue_requests(flight, start, clients, asks.requests, &mut issued);
        issued.awaits |= waits;
        issued.at_once = !waits && self.steps.is_empty();
        issued
    }

    /// Returns the blocking step that has just been issued, while any of its answers is unknown.
    pub(crate) fn blocking(&self) -> Option<&InFlightStep> {
        self.steps.back().filter(|flight| flight.is_blocking())
    }

    /// Returns a lower bound of the last answer that the blocking step waits for.
    pub(crate) fn no_release_before(&self, ids: &[usize], system: &mut MemorySystem) -> Cycle {
        let Some(flight) = self.blocking() else { return Cycle::ZERO };
        let awaited = flight.awaited(ids, system);
        ids.iter().zip(awaited).fold(Cycle::ZERO, |bound, (&client, answer)| {
            bound.max(if answer.is_known() { answer } else { system.earliest_answer(client) })
        })
    }

    /// Makes the look-ups of a step in one cache. Returns the least occupancy, and true if the step waits for any.
    #[inline]
    fn look_up(
        &mut self,
        flight: &mut InFlightStep,
        start: Cycle,
        clients: &mut MemoryClients<'_>,
        look_ups: &CacheLookUps,
        asks: &StepRequestsView<'_>,
    ) -> (u64, bool) {
        let own = look_ups.client as usize;
        let (client, system) = (clients.ids[own], &mut *clients.memories);
        let queue = &mut self.look_ups[own];
        if queue.steps.is_empty()
            && let Some((answer, least)) = system.hit(client, start, look_ups)
        {
            flight.answers[own] = answer;
            return (least, false);
        }
        let (pending, least) = system.look_up(client, start, look_ups, asks, &mut queue.open);
        let waits = pending.request > 0 || !queue.steps.is_empty();
        if waits {
            queue.steps.push_back(pending);
            flight.look_ups[own] += 1;
        } else {
            flight.answers[own] = system.resolve_at_once(client, &pending);
        }
        (least, waits)
    }

    /// Appends a step that waits. Adjacent steps without deliveries wait only to be counted, so they are merged.
    pub(crate) fn push(&mut self, mut flight: InFlightStep, clients: &mut MemoryClients<'_>) {
        match self.steps.back_mut() {
            Some(last) if last.delivery.outputs | flight.delivery.outputs == 0 => {
                for i in 0..clients.ids.len() {
                    last.look_ups[i] += flight.look_ups[i];
                    last.reads[i] = last.reads[i].max(flight.reads[i]);
                }
            }
            _ => {
                for (served, &client) in flight.served.iter_mut().zip(clients.ids) {
                    *served = clients.memories.served(client);
                }
                self.steps.push_back(flight);
            }
        }
        self.asked_at = None;
        if self.steps.len() == 1 {
            self.keep_answers(clients.ids, clients.memories);
        }
    }

    /// Calls `deliver` for steps whose answers are known and that have no step ahead of them on the same output, with these
    /// outputs. Returns true if there was any. `outputs`: outputs of the stage.
    ///
    /// A step does not wait for a step that emits nothing or emits elsewhere. Otherwise its delivery would be unknown although it
    /// does not depend on any answer, and the steps that it starts could issue requests earlier than [`MemorySystem::serve_safe`]
    /// assumes.
    pub(crate) fn deliver_known(
        &mut self,
        outputs: u32,
        clients: &mut MemoryClients<'_>,
        mut deliver: impl FnMut(&InFlightStep, u32),
    ) -> bool {
        let known = clients.memories.served_of(clients.ids);
        if self.asked_at.replace(known) == Some(known) {
            return false;
        }
        let mut moved = false;
        let (mut taken, mut stuck) = (0, 0);
        for flight in &mut self.steps {
            resolve(&mut self.look_ups, &mut stuck, flight, clients);
            if flight.is_answered(clients) {
                let free = flight.delivery.outputs & !taken;
                deliver(flight, free);
                moved |= free != 0;
                flight.delivery.outputs &= taken;
                if flight.delivery.outputs == 0 {
                    continue;
                }
            }
            taken |= flight.delivery.outputs;
            if taken & outputs == outputs {
                break;
            }
        }
        let before = self.steps.len();
        while self.steps.front_mut().is_some_and(|f| f.delivery.outputs == 0 && f.is_answered(clients)) {
            self.steps.pop_front();
        }
        if self.steps.len() < before {
            self.keep_answers(clients.ids, clients.memories);
        }
        moved
    }

    /// Calls `note` with the oldest step for each output.
    pub(crate) fn oldest(&self, mut note: impl FnMut(&InFlightStep, u32)) {
        let mut taken = 0;
        for flight in &self.steps {
            let first = flight.delivery.outputs & !taken;
            if first != 0 {
                note(flight, first);
            }
            taken |= first;
        }
    }

    /// Tells the memories which answers the oldest step in flight, and so any step, may still need.
    fn keep_answers(&self, ids: &[usize], memories: &mut MemorySystem) {
        for (i, &client) in ids.iter().enumerate() {
            memories.keep_from(client, self.steps.front().map_or(u64::MAX, |flight| flight.served[i]));
        }
    }
}

/// Issues the direct requests of a step. Returns true if it waits for any, and notes in `issued` the occupancy that they need.
#[inline]
fn issue_requests(
    flight: &mut InFlightStep,
    start: Cycle,
    clients: &mut MemoryClients<'_>,
    requests: &[Request],
    issued: &mut IssuedRequests,
) -> bool {
    let mut waits = false;
    for r in requests {
        let (number, arrival) = clients.memories.issue(clients.ids[r.client as usize], start, r);
        issued.least = issued.least.max(arrival.since(start) + 1);
        if !r.write {
            flight.reads[r.client as usize] = number + 1;
            waits = true;
            if flight.is_blocking() {
                issued.order.mention(r.client as usize);
            }
        }
    }
    waits
}

/// Takes in the answers to a step's look-ups, unless an earlier step on the same client is `stuck` (one bit each).
#[inline]
fn resolve(queues: &mut [LookUpQueue; MAX_CLIENTS], stuck: &mut u32, flight: &mut InFlightStep, clients: &mut MemoryClients<'_>) {
    for (i, (queue, &client)) in queues.iter_mut().zip(clients.ids).enumerate() {
        let left = &mut flight.look_ups[i];
        if *left > 0 && *stuck & 1 << i == 0 {
            clients.memories.resolve(client, queue, left, &mut flight.answers[i]);
            *stuck |= u32::from(*left > 0) << i;
        }
    }
}
