//! What a stage has in flight: steps that wait for memory answers, or behind such a step (laws 4 and 5).

use crate::capacity::{MAX_CLIENTS, MAX_LINKS};
use crate::memory_system::LookUpQueue;
use crate::step_requests::{CacheLookUps, StepRequestsView};
use crate::{Cycle, MemorySystem, Request};
use std::collections::VecDeque;

/// A step's delivery, as far as it does not depend on memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Delivery {
    /// Start + latency: it is not delivered before.
    pub(crate) base: Cycle,
    /// Outputs that get a token, one bit each; [`MARKED`] stands beside them.
    pub(crate) outputs: u32,
}

/// Bit of [`Delivery::outputs`]: the delivery passes a mark.
pub(crate) const MARKED: u32 = 1 << MAX_LINKS;

/// A step that has issued its traffic.
#[derive(Clone, Debug)]
pub(crate) struct InFlightStep {
    pub(crate) delivery: Delivery,
    /// Steps whose look-ups have no answer, by client: its own, and those that it waits for, too.
    look_ups: [u32; MAX_CLIENTS],
    /// Number of the last read by client, plus one; 0 for none, or once its answer is known.
    reads: [u64; MAX_CLIENTS],
    /// Last answers known so far.
    pub(crate) answers: [Cycle; MAX_CLIENTS],
    /// Requests served when it was issued, by client: it waits for none before.
    served: [u64; MAX_CLIENTS],
}

impl InFlightStep {
    /// A step without traffic.
    #[inline]
    pub(crate) fn new(delivery: Delivery) -> Self {
        let (look_ups, reads, answers, served) = Default::default();
        Self { delivery, look_ups, reads, answers, served }
    }

    /// When the step delivers, all its answers known.
    #[inline]
    pub(crate) fn delivered(&self) -> Cycle {
        self.answers.iter().fold(self.delivery.base, |latest, answer| latest.max(*answer))
    }

    /// Whether all answers are known, once the answers to reads are taken in.
    #[inline(always)]
    fn is_answered(&mut self, ids: &[usize], system: &MemorySystem) -> bool {
        for ((&client, reads), last) in ids.iter().zip(&mut self.reads).zip(&mut self.answers) {
            if let Some(number) = reads.checked_sub(1) {
                let answer = system.answer(client, number);
                if !answer.is_known() {
                    return false;
                }
                *last = answer.max(*last);
                *reads = 0;
            }
        }
        self.look_ups == [0; MAX_CLIENTS]
    }

    /// Until when it waits for each client's answers, as far as that is known by now.
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

/// Steps in flight, oldest first.
#[derive(Clone, Debug, Default)]
pub(crate) struct InFlightSteps {
    steps: VecDeque<InFlightStep>,
    /// Their look-ups that have no answer yet, by client, in order.
    look_ups: [LookUpQueue; MAX_CLIENTS],
    /// Answers that were known when the steps were last asked whether they have theirs: until there are more, none has.
    asked_at: Option<u64>,
}

impl InFlightSteps {
    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// Issues what a step asks that starts at `start`; the least occupancy that its look-ups need (law 5), and whether all its
    /// answers are known and nothing is ahead of it, so that it can deliver at once.
    #[inline]
    pub(crate) fn issue(
        &mut self,
        flight: &mut InFlightStep,
        start: Cycle,
        (ids, system): (&[usize], &mut MemorySystem),
        asks: StepRequestsView<'_>,
    ) -> (u64, bool) {
        let mut least = 1;
        let mut waits = false;
        let requests = asks.look_ups(|look_ups, held, new| {
            let (cycles, waits_too) = self.look_up(flight, start, (ids, &mut *system), (look_ups, held, new));
            least = least.max(cycles);
            waits |= waits_too;
        });
        waits |= issue_requests(flight, start, (ids, system), requests);
        (least, !waits && self.steps.is_empty())
    }

    /// Makes the look-ups of a step in one cache; the least occupancy, and whether it waits for any.
    #[inline]
    fn look_up(
        &mut self,
        flight: &mut InFlightStep,
        start: Cycle,
        (ids, system): (&[usize], &mut MemorySystem),
        look_up: (&CacheLookUps, &[u64], &[u64]),
    ) -> (u64, bool) {
        let own = look_up.0.client as usize;
        let queue = &mut self.look_ups[own];
        let (pending, least) = system.look_up(ids[own], start, look_up, &mut queue.open);
        let waits = pending.request > 0 || !queue.steps.is_empty();
        if waits {
            queue.steps.push_back(pending);
            flight.look_ups[own] += 1;
        } else {
            flight.answers[own] = system.resolve_at_once(ids[own], &pending);
        }
        (least, waits)
    }

    /// Takes in a step that waits. Steps that deliver nothing wait only to be counted: those in a row wait as one.
    pub(crate) fn push(&mut self, mut flight: InFlightStep, (ids, system): (&[usize], &mut MemorySystem)) {
        match self.steps.back_mut() {
            Some(last) if last.delivery.outputs | flight.delivery.outputs == 0 => {
                for i in 0..ids.len() {
                    last.look_ups[i] += flight.look_ups[i];
                    last.reads[i] = last.reads[i].max(flight.reads[i]);
                }
            }
            _ => {
                for (served, &client) in flight.served.iter_mut().zip(ids) {
                    *served = system.served(client);
                }
                self.steps.push_back(flight);
            }
        }
        self.asked_at = None;
        if self.steps.len() == 1 {
            self.keep_answers(ids, system);
        }
    }

    /// Hands steps to `deliver` whose answers are known by now and that have nothing ahead of them on the same output, with
    /// these outputs; tells whether there were any. `outputs`: those that the stage has.
    ///
    /// A step waits for no other: not for one that emits nothing, nor for one that emits elsewhere. Were it to wait here
    /// for what is ahead, its delivery would be unknown although it does not depend on any answer, and what starts upon it
    /// could issue requests earlier than [`MemorySystem::serve_safe`] may assume.
    pub(crate) fn land(
        &mut self,
        outputs: u32,
        (ids, system): (&[usize], &mut MemorySystem),
        mut deliver: impl FnMut(&InFlightStep, u32),
    ) -> bool {
        let known = system.served_of(ids);
        if self.asked_at.replace(known) == Some(known) {
            return false;
        }
        let mut moved = false;
        let (mut taken, mut stuck) = (0, 0);
        for flight in &mut self.steps {
            resolve(&mut self.look_ups, &mut stuck, flight, ids, system);
            if flight.is_answered(ids, system) {
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
        while self.steps.front_mut().is_some_and(|f| f.delivery.outputs == 0 && f.is_answered(ids, system)) {
            self.steps.pop_front();
        }
        if self.steps.len() < before {
            self.keep_answers(ids, system);
        }
        moved
    }

    /// Shows `note`, for each output, the oldest step that delivers there.
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

    /// Tells the memories which answers the oldest step in flight, and so any, may still ask for.
    fn keep_answers(&self, ids: &[usize], system: &mut MemorySystem) {
        for (i, &client) in ids.iter().enumerate() {
            system.keep_from(client, self.steps.front().map_or(u64::MAX, |flight| flight.served[i]));
        }
    }
}

/// Issues the direct requests of a step; whether it waits for any.
#[inline]
fn issue_requests(
    flight: &mut InFlightStep,
    start: Cycle,
    (ids, system): (&[usize], &mut MemorySystem),
    requests: &[Request],
) -> bool {
    let mut waits = false;
    for r in requests {
        let number = system.issue(ids[r.client as usize], start, r.address, r.bytes, r.write);
        if !r.write {
            flight.reads[r.client as usize] = number + 1;
            waits = true;
        }
    }
    waits
}

/// Takes in the answers to a step's look-ups, unless one ahead of it on the same client is `stuck` (a bit each).
#[inline]
fn resolve(
    queues: &mut [LookUpQueue; MAX_CLIENTS],
    stuck: &mut u32,
    flight: &mut InFlightStep,
    ids: &[usize],
    system: &mut MemorySystem,
) {
    for (i, (queue, &client)) in queues.iter_mut().zip(ids).enumerate() {
        let left = &mut flight.look_ups[i];
        if *left > 0 && *stuck & 1 << i == 0 {
            system.resolve(client, queue, left, &mut flight.answers[i]);
            *stuck |= u32::from(*left > 0) << i;
        }
    }
}
