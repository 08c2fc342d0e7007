//! A unit in its place: when it is free, what it has in flight, where its cycles went.

use crate::account::{Account, Cause};
use crate::flight::{Delivery, ENDS_FRAME, Flight, Flights};
use crate::probe::Probe;
use crate::wiring::{Clients, Inputs, MAX_CLIENTS, Outputs};
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
    /// Deliveries that ended a frame, not yet collected.
    pub(crate) frame_ends: Vec<Cycle>,
}

/// What a stage asks of its memory clients in every step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Needs {
    /// Credits that the largest step needs, by client.
    credits: [u32; MAX_CLIENTS],
    /// Clients in the order in which their memories serve them.
    served_in_order: [usize; MAX_CLIENTS],
}

/// What is known of the start of the next step.
pub(crate) struct Start {
    pub(crate) at: Cycle,
    pub(crate) demand: Demand,
}

/// The earliest start of the unit's next step (law 3); `None` if it will make no further step.
///
/// What runs in every step is marked to be inlined always: a step is a dozen comparisons, and left to itself the compiler
/// inlines them or not as it happens to divide the crates into units of code.
#[inline(always)]
pub(crate) fn next_start<U: Unit, I: Inputs, O: Outputs, const M: bool>(
    unit: &U,
    clock: &Clock,
    inputs: &I,
    outputs: &O,
    clients: &Clients<'_, M>,
) -> Option<Start> {
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
    if let Some(system) = clients.system() {
        for (&client, &credits) in clients.ids().iter().zip(&clock.needs.credits) {
            at = at.max(system.credits_at(client, credits));
        }
    }
    Some(Start { at, demand })
}

/// Promises that the unit makes no step before it can at the earliest: with what its neighbours have promised, where they have
/// not come so far yet. Its neighbours build on that in turn, and its memories serve what others asked for until then.
#[inline(always)]
pub(crate) fn promise<I: Inputs, O: Outputs, const M: bool>(
    demand: Demand,
    free: Cycle,
    (inputs, outputs, clients): (&mut I, &mut O, &mut Clients<'_, M>),
) {
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
    let ids = clients.ids();
    if let Some(system) = clients.system_mut() {
        ids.iter().for_each(|&client| system.promise(client, start));
    }
}

/// Splits the wait from `from` to `to` into its causes (law 9), in order, and hands each to `charge`.
///
/// In each cycle the first cause that applies counts; every condition, once met, stays met until the step starts. So
/// the causes follow each other in the order in which they are tried, and a running maximum splits the interval.
pub(crate) fn split_wait<I: Inputs, O: Outputs, const M: bool>(
    needs: &Needs,
    demand: Demand,
    wires: (&I, &O, &Clients<'_, M>),
    (from, to): (Cycle, Cycle),
    mut charge: impl FnMut(Wait),
) {
    let (inputs, outputs, clients) = wires;
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
    if let Some(system) = clients.system() {
        for (i, (&client, &credits)) in clients.ids().iter().zip(&needs.credits).enumerate() {
            if until(Cause::Memory(i), system.credits_at(client, credits)) {
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

impl Clock {
    /// Starts a run: asks what does not change during it.
    pub(crate) fn attach<U: Unit, O: Outputs, const M: bool>(&mut self, unit: &U, outputs: &mut O, clients: &Clients<'_, M>) {
        let ids = clients.ids();
        for i in 0..outputs.count() {
            outputs.link_mut(i).keep_awaits(!ids.is_empty());
        }
        self.needs.credits = std::array::from_fn(|i| if i < ids.len() { unit.largest_step(i) } else { 0 });
        self.needs.served_in_order = std::array::from_fn(|i| i);
        if let Some(system) = clients.system() {
            self.needs.served_in_order[..ids.len()].sort_by_key(|&i| system.service_rank(ids[i]));
        }
    }

    /// Makes one step at `start`.
    #[inline(always)]
    pub(crate) fn fire<U: Unit, I: Inputs<Item = U::In>, O: Outputs<Item = U::Out>, const M: bool>(
        &mut self,
        unit: &mut U,
        demand: Demand,
        start: Cycle,
        wires: (&mut I, &mut O, &mut Clients<'_, M>),
        traffic: &mut Traffic,
    ) {
        let (inputs, outputs, clients) = wires;
        let item = inputs.pop(demand, start);
        let step = unit.step(item, traffic);
        if step.occupancy == 0 {
            traffic.fault("a step kept its unit for 0 cycles, expected at least 1 (law 3)".into());
        }
        let mask = outputs.reserve(start, step.out);
        let outputs_and_frame = mask | if step.ends_frame { ENDS_FRAME } else { 0 };
        let delivery = Delivery { base: start + step.latency, outputs: outputs_and_frame };
        let mut occupancy = step.occupancy;
        if !M || (traffic.is_empty() && self.flights.is_empty()) {
            deliver(&mut self.frame_ends, delivery.outputs, delivery.base, outputs);
        } else {
            occupancy = occupancy.max(self.depart(start, delivery, outputs, clients, traffic));
        }
        self.account.busy += occupancy;
        self.free = start + occupancy;
        self.steps += 1;
    }

    /// Issues a step's traffic, and delivers it if all answers are known; the least occupancy that its look-ups need.
    fn depart<O: Outputs, const M: bool>(
        &mut self,
        start: Cycle,
        delivery: Delivery,
        outputs: &mut O,
        clients: &mut Clients<'_, M>,
        traffic: &mut Traffic,
    ) -> u64 {
        let ids = clients.ids();
        let Some(system) = clients.system_mut() else { return 1 };
        let mut flight = Flight::new(delivery);
        let (least, at_once) = self.flights.issue(&mut flight, start, (ids, system), traffic);
        let requests = !traffic.requests.is_empty();
        traffic.clear();
        if at_once {
            deliver_answered(&mut self.frame_ends, &flight, delivery.outputs, outputs);
        } else {
            self.flights.push(flight, (ids, system));
        }
        // Private memories answer at once, and so the step may land.
        if (requests || !at_once) && ids.iter().fold(false, |any, &client| system.serve_if_private(client) | any) {
            self.land_known(outputs, clients);
        }
        least
    }

    /// Delivers the steps in flight whose answers are known by now, and tells whether there were any. To be called
    /// before looking at the next start.
    ///
    /// A step may overtake those ahead that deliver nothing where it does, such as fragments that failed the z-test: its
    /// token must not seem to wait for their answers, or requests that it leads to would be served too late.
    #[inline(always)]
    pub(crate) fn land_known<O: Outputs, const M: bool>(&mut self, outputs: &mut O, clients: &mut Clients<'_, M>) -> bool {
        if !M || self.flights.is_empty() {
            return false;
        }
        let ids = clients.ids();
        let Some(system) = clients.system_mut() else { return false };
        let all = (1 << outputs.count()) - 1;
        let Self { flights, frame_ends, .. } = self;
        flights.land(all, (ids, system), |flight, to| deliver_answered(frame_ends, flight, to, outputs))
    }
}

/// Delivers a step that has its answers, to these of its outputs.
#[inline]
fn deliver_answered<O: Outputs>(frame_ends: &mut Vec<Cycle>, flight: &Flight, to: u32, outputs: &mut O) {
    for i in (0..outputs.count()).filter(|i| to & 1 << i != 0) {
        outputs.link_mut(i).set_awaits(flight.answers);
    }
    deliver(frame_ends, to, flight.delivered(), outputs);
}

#[inline(always)]
fn deliver<O: Outputs>(frame_ends: &mut Vec<Cycle>, to: u32, at: Cycle, outputs: &mut O) {
    for i in (0..outputs.count()).filter(|i| to & 1 << i != 0) {
        outputs.link_mut(i).deliver(at);
    }
    if to & ENDS_FRAME != 0 {
        frame_ends.push(at);
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
