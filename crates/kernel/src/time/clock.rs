//! The times of a stage: when it is free, what it has in flight, where its cycles went.

use super::ends::Ends;
use super::flight::{Delivery, Flight, Flights, MARKED, objection};
use super::{Known, Made, Slots};
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
    pub(super) busy: u64,
    /// Its FIFOs.
    pub(super) inputs: Ends,
    pub(super) outputs: Ends,
    /// Its steps keep it for a cycle, and deliver as much earlier.
    ideal: bool,
    /// Numbers of its memory clients.
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
        let StageShape { inputs, outputs, clients, credits, ideal, .. } = shape;
        let mut served_in_order = std::array::from_fn(|i| i);
        served_in_order[..clients.len()].sort_by_key(|&i| memories.service_rank(clients[i]));
        Self {
            free: Cycle::ZERO,
            steps: 0,
            busy: 0,
            ideal: *ideal,
            inputs: Ends::new(inputs),
            outputs: Ends::new(outputs),
            clients: clients.as_slice().into(),
            needs: Needs { credits: *credits, served_in_order },
            flights: Flights::default(),
            marks: Vec::new(),
        }
    }

    /// Makes a step that starts at `at` and takes these `inputs`: takes it into the times of its FIFOs, and issues its traffic.
    #[inline(always)]
    pub(super) fn step<K: Known>(
        &mut self,
        (at, inputs): (Cycle, u32),
        made: &Made,
        (fifos, memories): (&mut [Slots], &mut MemorySystem),
        traffic: &mut Traffic,
    ) {
        self.inputs.each(inputs, K::INPUTS, |fifo| fifos[fifo].pop(at));
        self.outputs.each(made.outputs, K::OUTPUTS, |fifo| fifos[fifo].reserve(at));
        let (mut occupancy, latency) = self.kept(made);
        if traffic.is_empty() && (!K::HAS_MEMORY || self.flights.is_empty()) {
            self.outputs.each(made.outputs, K::OUTPUTS, |fifo| fifos[fifo].deliver(at + latency));
            if made.marked {
                self.marks.push(at + latency);
            }
        } else {
            let outputs = made.outputs | if made.marked { MARKED } else { 0 };
            occupancy = occupancy.max(self.depart(at, (at + latency, outputs), (fifos, memories), traffic));
        }
        self.busy += occupancy;
        self.free = at + occupancy;
        self.steps += 1;
    }

    /// How long a step keeps the unit, and how long it takes to deliver, as far as it does not depend on memory.
    #[inline(always)]
    pub(super) fn kept(&self, &Made { occupancy, latency, .. }: &Made) -> (u64, u64) {
        if self.ideal { (1, latency.saturating_sub(occupancy.saturating_sub(1))) } else { (occupancy, latency) }
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
            deliver_answered(&mut self.marks, self.outputs, &flight, outputs, fifos);
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
        flights.land(outputs.all(), (clients, memories), |flight, to| deliver_answered(marks, *outputs, flight, to, fifos))
    }

    /// Notes what the oldest slot holders wait for, as far as it is known by now: for who asks in every cycle.
    pub(crate) fn note_awaits(&self, fifos: &mut [Slots], memories: &MemorySystem) {
        if self.clients.is_empty() {
            return;
        }
        self.flights.oldest(|flight, to| {
            for (_, fifo) in self.outputs.of(to & self.outputs.all()) {
                fifos[fifo].set_awaits(flight.awaited(&self.clients, memories));
            }
        });
    }
}

/// Delivers a step that has its answers, to these of its outputs.
fn deliver_answered(marks: &mut Vec<Cycle>, outputs: Ends, flight: &Flight, to: u32, fifos: &mut [Slots]) {
    let at = flight.delivered();
    for (_, fifo) in outputs.of(to & outputs.all()) {
        fifos[fifo].set_awaits(flight.answers);
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
