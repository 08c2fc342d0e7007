//! The times of a stage: when it is free, what it has in flight, where its cycles went.

use super::Slots;
use super::flight::{Delivery, Flight, Flights, MARKED, objection};
use crate::account::{Account, Cause};
use crate::probe::Probe;
use crate::shape::StageShape;
use crate::wiring::MAX_CLIENTS;
use crate::{Cycle, MemorySystem, Traffic};

/// A wait: why, its first cycle, and the cycle after its last.
pub(crate) type Wait = (Cause, Cycle, Cycle);

/// The times of a stage.
#[derive(Clone, Debug)]
pub(crate) struct Clock {
    pub(crate) free: Cycle,
    pub(crate) steps: u64,
    /// Numbers of its FIFOs and memory clients.
    pub(super) inputs: Box<[usize]>,
    pub(super) outputs: Box<[usize]>,
    pub(super) clients: Box<[usize]>,
    pub(super) needs: Needs,
    pub(super) flights: Flights,
    /// Deliveries that passed a mark.
    pub(super) marks: Vec<Cycle>,
}

/// What a stage asks of its memory clients in every step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Needs {
    /// Credits that the largest step needs, by client.
    pub(super) credits: [u32; MAX_CLIENTS],
    /// Clients in the order in which their memories serve them.
    pub(super) served_in_order: [usize; MAX_CLIENTS],
}

impl Clock {
    pub(super) fn new(shape: &StageShape, memories: &MemorySystem) -> Self {
        let StageShape { inputs, outputs, clients, credits, .. } = shape;
        let mut served_in_order = std::array::from_fn(|i| i);
        served_in_order[..clients.len()].sort_by_key(|&i| memories.service_rank(clients[i]));
        Self {
            free: Cycle::ZERO,
            steps: 0,
            inputs: inputs.as_slice().into(),
            outputs: outputs.as_slice().into(),
            clients: clients.as_slice().into(),
            needs: Needs { credits: *credits, served_in_order },
            flights: Flights::default(),
            marks: Vec::new(),
        }
    }

    /// Delivers to these of its outputs.
    #[inline(always)]
    pub(super) fn deliver(&mut self, to: u32, at: Cycle, fifos: &mut [Slots]) {
        deliver(&mut self.marks, &self.outputs, to, at, fifos);
    }

    /// Issues a step's traffic, and delivers it if all answers are known; the least occupancy that its look-ups need.
    pub(super) fn depart(
        &mut self,
        start: Cycle,
        (base, outputs): (Cycle, u32),
        (fifos, memories): (&mut [Slots], &mut MemorySystem),
        traffic: &mut Traffic,
    ) -> u64 {
        let mut flight = Flight::new(Delivery { base, outputs });
        let issued = self.flights.issue(&mut flight, start, (&self.clients, memories), traffic, &self.needs.credits);
        let Some((least, at_once)) = issued else {
            // What the unit did not declare, or nothing is wired for: the next stage must not issue it.
            let text = objection((&self.clients, memories), &self.needs.credits, traffic);
            traffic.clear();
            traffic.fault(text);
            return 1;
        };
        traffic.clear();
        if at_once {
            deliver_answered(&mut self.marks, &self.outputs, &flight, outputs, fifos);
        } else {
            self.flights.push(flight, (&self.clients, memories));
        }
        least
    }

    /// Delivers the steps in flight whose answers are known by now, and tells whether there were any.
    ///
    /// A step may overtake those ahead that deliver nothing where it does, such as tokens that a test let go no further: its
    /// token must not seem to wait for their answers, or requests that it leads to would be served too late.
    pub(super) fn land(&mut self, fifos: &mut [Slots], memories: &mut MemorySystem) -> bool {
        let Self { flights, marks, outputs, clients, .. } = self;
        let all = (1 << outputs.len()) - 1;
        flights.land(all, (clients, memories), |flight, to| deliver_answered(marks, outputs, flight, to, fifos))
    }

    /// Notes what the oldest slot holders wait for, as far as it is known by now: for who asks in every cycle.
    pub(crate) fn note_awaits(&self, fifos: &mut [Slots], memories: &MemorySystem) {
        if self.clients.is_empty() {
            return;
        }
        self.flights.oldest(|flight, to| {
            for (_, &fifo) in taking(&self.outputs, to) {
                fifos[fifo].set_awaits(flight.awaited(&self.clients, memories));
            }
        });
    }
}

/// Those of the outputs that get a token.
#[inline(always)]
fn taking(outputs: &[usize], to: u32) -> impl Iterator<Item = (usize, &usize)> {
    outputs.iter().enumerate().filter(move |(i, _)| to & 1 << i != 0)
}

/// Delivers a step that has its answers, to these of its outputs.
#[inline]
fn deliver_answered(marks: &mut Vec<Cycle>, outputs: &[usize], flight: &Flight, to: u32, fifos: &mut [Slots]) {
    for (_, &fifo) in taking(outputs, to) {
        fifos[fifo].set_awaits(flight.answers);
    }
    deliver(marks, outputs, to, flight.delivered(), fifos);
}

#[inline(always)]
fn deliver(marks: &mut Vec<Cycle>, outputs: &[usize], to: u32, at: Cycle, fifos: &mut [Slots]) {
    for (_, &fifo) in taking(outputs, to) {
        fifos[fifo].deliver(at);
    }
    if to & MARKED != 0 {
        marks.push(at);
    }
}

/// Charges a wait of stage `stage` to its account and shows it to the probe.
#[inline]
pub(crate) fn charge<P: Probe>(account: &mut Account, probe: &mut P, stage: usize, (cause, from, to): Wait) {
    account.charge(cause, to.since(from));
    if P::is_on() {
        probe.waited(stage, cause, from, to);
    }
}
