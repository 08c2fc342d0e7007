//! A unit in its place: when it is free, what it has in flight, where its cycles went.

use crate::account::{Account, Cause};
use crate::connections::{Clients, Connections};
use crate::flight::{Delivery, Flight, Flights, MARKED, objection};
use crate::probe::Probe;
use crate::wiring::{Inputs, MAX_CLIENTS, Outputs};
use crate::{Cycle, Demand, Traffic, Unit};

/// A unit together with its times.
#[derive(Clone, Debug)]
pub struct Stage<U> {
    name: String,
    /// The unit; its state may be read between runs.
    pub unit: U,
    pub(crate) clock: Clock,
}

impl<U: Unit> Stage<U> {
    /// A unit under the name it has in the block diagram.
    pub fn new(name: &str, unit: U) -> Self {
        Self { name: name.into(), unit, clock: Clock::default() }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Steps made so far.
    pub fn steps(&self) -> u64 {
        self.clock.steps
    }

    /// Makes one step.
    #[inline(always)]
    pub(crate) fn fire<I, O, C>(&mut self, start: &Start, connections: &mut Connections<I, O, C>, traffic: &mut Traffic)
    where
        I: Inputs<Item = U::In>,
        O: Outputs<Item = U::Out>,
        C: Clients,
    {
        let (Self { unit, clock, .. }, &Start { at, demand }) = (self, start);
        let item = connections.inputs.pop(demand, at);
        let step = unit.step(item, traffic);
        if step.occupancy == 0 {
            traffic.fault("a step kept its unit for 0 cycles, expected at least 1 (law 3)".into());
        }
        let mask = connections.outputs.reserve(at, step.out);
        let outputs_and_mark = mask | if step.marked { MARKED } else { 0 };
        let delivery = Delivery { base: at + step.latency, outputs: outputs_and_mark };
        let mut occupancy = step.occupancy;
        if !C::HAS_MEMORY && !traffic.is_empty() {
            refuse(&mut connections.clients, &clock.needs, traffic);
        }
        if !C::HAS_MEMORY || (traffic.is_empty() && clock.flights.is_empty()) {
            deliver(&mut clock.marks, delivery.outputs, delivery.base, &mut connections.outputs);
        } else {
            occupancy = occupancy.max(clock.depart(at, delivery, connections, traffic));
        }
        clock.account.busy += occupancy;
        clock.free = at + occupancy;
        clock.steps += 1;
    }
}

/// A wait: why, its first cycle, and the cycle after its last.
pub(crate) type Wait = (Cause, Cycle, Cycle);

/// The times of a stage.
#[derive(Clone, Debug, Default)]
pub(crate) struct Clock {
    pub(crate) free: Cycle,
    pub(crate) steps: u64,
    pub(crate) account: Account,
    /// Waits since the last step, cycle by cycle; the ticked engine's.
    pub(crate) waits: Vec<Wait>,
    pub(crate) needs: Needs,
    flights: Flights,
    /// Deliveries that passed a mark, not yet collected.
    pub(crate) marks: Vec<Cycle>,
}

/// What a stage asks of its memory clients in every step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Needs {
    /// Credits that the largest step needs, by client.
    pub(crate) credits: [u32; MAX_CLIENTS],
    /// Clients in the order in which their memories serve them.
    pub(crate) served_in_order: [usize; MAX_CLIENTS],
}

/// What is known of the start of the next step.
pub(crate) struct Start {
    pub(crate) at: Cycle,
    pub(crate) demand: Demand,
}

impl Clock {
    /// Starts a run: asks what does not change during it.
    pub(crate) fn attach<I, O: Outputs, C: Clients>(&mut self, unit: &impl Unit, connections: &mut Connections<I, O, C>) {
        let Connections { outputs, clients, .. } = connections;
        let ids = clients.ids();
        for i in 0..outputs.count() {
            outputs.link_mut(i).keep_awaits(!ids.is_empty());
        }
        self.needs.credits = std::array::from_fn(|i| if i < ids.len() { unit.largest_step(i) } else { 0 });
        self.needs.served_in_order = std::array::from_fn(|i| i);
        if let Some(memories) = clients.memories() {
            self.needs.served_in_order[..ids.len()].sort_by_key(|&i| memories.service_rank(ids[i]));
        }
    }

    /// Issues a step's traffic, and delivers it if all answers are known; the least occupancy that its look-ups need.
    fn depart<I, O: Outputs, C: Clients>(
        &mut self,
        start: Cycle,
        delivery: Delivery,
        connections: &mut Connections<I, O, C>,
        traffic: &mut Traffic,
    ) -> u64 {
        let Connections { outputs, clients, .. } = &mut *connections;
        let Some((ids, memories)) = clients.open() else { return 1 };
        let mut flight = Flight::new(delivery);
        let issued = self.flights.issue(&mut flight, start, (ids, memories), traffic, &self.needs.credits);
        let Some((least, at_once)) = issued else {
            refuse(clients, &self.needs, traffic);
            return 1;
        };
        traffic.clear();
        if at_once {
            deliver_answered(&mut self.marks, &flight, delivery.outputs, outputs);
        } else {
            self.flights.push(flight, (ids, memories));
        }
        least
    }

    /// Notes what the oldest slot holders wait for, as far as it is known by now: for who asks in every cycle.
    pub(crate) fn note_awaits<I, O: Outputs, C: Clients>(&self, connections: &mut Connections<I, O, C>) {
        let Connections { outputs, clients, .. } = connections;
        let (Some(memories), ids) = (clients.memories(), clients.ids()) else { return };
        self.flights.oldest(|flight, to| {
            for i in (0..outputs.count()).filter(|i| to & 1 << i != 0) {
                outputs.link_mut(i).set_awaits(flight.awaited(ids, memories));
            }
        });
    }

    /// Delivers the steps in flight whose answers are known by now, and tells whether there were any. To be called
    /// before looking at the next start.
    ///
    /// A step may overtake those ahead that deliver nothing where it does, such as tokens that a test let go no further: its
    /// token must not seem to wait for their answers, or requests that it leads to would be served too late.
    #[inline(always)]
    pub(crate) fn land_known<I, O: Outputs, C: Clients>(&mut self, connections: &mut Connections<I, O, C>) -> bool {
        if !C::HAS_MEMORY || self.flights.is_empty() {
            return false;
        }
        let Connections { outputs, clients, .. } = connections;
        let Some((ids, memories)) = clients.open() else { return false };
        let all = (1 << outputs.count()) - 1;
        let Self { flights, marks, .. } = self;
        flights.land(all, (ids, memories), |flight, to| deliver_answered(marks, flight, to, outputs))
    }
}

/// Faults on traffic that the unit did not declare, or for which nothing is wired: the next stage must not issue it.
#[cold]
fn refuse(clients: &mut impl Clients, needs: &Needs, traffic: &mut Traffic) {
    let text = objection(clients, &needs.credits, traffic);
    traffic.clear();
    traffic.fault(text);
}

/// Delivers a step that has its answers, to these of its outputs.
#[inline]
fn deliver_answered<O: Outputs>(marks: &mut Vec<Cycle>, flight: &Flight, to: u32, outputs: &mut O) {
    for i in (0..outputs.count()).filter(|i| to & 1 << i != 0) {
        outputs.link_mut(i).set_awaits(flight.answers);
    }
    deliver(marks, to, flight.delivered(), outputs);
}

#[inline(always)]
fn deliver<O: Outputs>(marks: &mut Vec<Cycle>, to: u32, at: Cycle, outputs: &mut O) {
    for i in (0..outputs.count()).filter(|i| to & 1 << i != 0) {
        outputs.link_mut(i).deliver(at);
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
