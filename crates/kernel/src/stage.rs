//! A unit in its place: when it is free, what it has in flight, where its cycles went.

use crate::account::{Account, Cause};
use crate::cache::LookUp;
use crate::probe::Probe;
use crate::wiring::{Clients, Inputs, MAX_CLIENTS, MAX_LINKS, Outputs};
use crate::{Cycle, Demand, Traffic, Unit};
use std::collections::VecDeque;

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

/// A step that waits for memory answers, or for such a step ahead of it.
#[derive(Clone, Copy, Debug)]
struct InFlight {
    /// Start + latency: it is not delivered before.
    base: Cycle,
    /// Outputs that got a token.
    mask: u32,
    ends_frame: bool,
    /// Look-ups of this step, per client, at the front of the client's queue.
    look_ups: [u16; MAX_CLIENTS],
    /// Number of the last read per client, plus one; 0 for none.
    reads: [u64; MAX_CLIENTS],
    /// Answers known so far.
    answers: [Cycle; MAX_CLIENTS],
    /// Requests served when it started, per client: it waits for none before.
    served: [u64; MAX_CLIENTS],
}

impl InFlight {
    fn new(base: Cycle, mask: u32, ends_frame: bool) -> Self {
        let (look_ups, reads, answers, served) = Default::default();
        Self { base, mask, ends_frame, look_ups, reads, answers, served }
    }

    /// What must be delivered in order: its outputs, and the end of a frame. 0 where nothing waits for it.
    fn holds(&self) -> u32 {
        self.mask | u32::from(self.ends_frame) << MAX_LINKS
    }

    /// Takes over what a later step waits for, if both deliver nothing and the count has room.
    fn absorb(&mut self, later: &Self) -> bool {
        let mut sum = [0; MAX_CLIENTS];
        for (i, sum) in sum.iter_mut().enumerate() {
            let Some(n) = self.look_ups[i].checked_add(later.look_ups[i]) else { return false };
            *sum = n;
        }
        self.look_ups = sum;
        (0..MAX_CLIENTS).for_each(|i| self.reads[i] = self.reads[i].max(later.reads[i]));
        true
    }
}

/// The times of a stage.
#[derive(Clone, Debug, Default)]
pub(crate) struct Clock {
    pub(crate) free: Cycle,
    pub(crate) steps: u64,
    pub(crate) account: Account,
    /// Waits since the last step, cycle by cycle; the ticked engine's.
    pub(crate) waits: Vec<(Cause, Cycle, Cycle)>,
    in_flight: VecDeque<InFlight>,
    look_ups: [VecDeque<LookUp>; MAX_CLIENTS],
    /// Deliveries that ended a frame, not yet collected.
    pub(crate) frame_ends: Vec<Cycle>,
}

/// What is known of the start of the next step.
pub(crate) struct Start {
    pub(crate) at: Cycle,
    pub(crate) demand: Demand,
}

/// The earliest start of the unit's next step (law 3); `None` if it will make no further step.
#[inline]
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
    if let Some(system) = clients.system() {
        for (i, &client) in clients.ids().iter().enumerate() {
            at = at.max(system.credits_at(client, unit.largest_step(i)));
        }
    }
    for i in 0..outputs.count() {
        at = at.max(outputs.link(i).room_at());
    }
    Some(Start { at, demand })
}

/// Splits the wait from `from` to `to` into its causes (law 9), in order, and hands each to `charge`.
///
/// In each cycle the first cause that applies counts; every condition, once met, stays met until the step starts. So
/// the causes follow each other in the order in which they are tried, and a running maximum splits the interval.
pub(crate) fn split_wait<U: Unit, I: Inputs, O: Outputs, const M: bool>(
    unit: &U,
    demand: Demand,
    wires: (&I, &O, &Clients<'_, M>),
    (from, to): (Cycle, Cycle),
    mut charge: impl FnMut(Cause, Cycle, Cycle),
) {
    let (inputs, outputs, clients) = wires;
    let mut at = from;
    let mut until = |cause: Cause, end: Cycle| {
        let end = end.min(to);
        if end > at {
            charge(cause, at, end);
            at = end;
        }
    };
    for i in (0..inputs.count()).filter(|&i| demand.takes(i)) {
        until(Cause::Starved(i), inputs.link(i).front_visible());
    }
    if let Some(system) = clients.system() {
        for (i, &client) in clients.ids().iter().enumerate() {
            until(Cause::Memory(i), system.credits_at(client, unit.largest_step(i)));
        }
    }
    for i in 0..outputs.count() {
        let link = outputs.link(i);
        let room = link.room_at();
        for client in answer_order(clients) {
            until(Cause::Memory(client), link.oldest_awaits(client).min(room));
        }
        until(Cause::Blocked(i), room);
    }
}

/// A stage's clients in the order in which their memories serve them.
fn answer_order<const M: bool>(clients: &Clients<'_, M>) -> impl Iterator<Item = usize> + use<M> {
    let mut order: [usize; MAX_CLIENTS] = std::array::from_fn(|i| i);
    let count = clients.ids().len();
    if let (Some(system), true) = (clients.system(), count > 1) {
        order[..count].sort_by_key(|&i| system.service_rank(clients.ids()[i]));
    }
    order.into_iter().take(count)
}

impl Clock {
    /// Makes one step at `start`.
    #[inline]
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
        let mut occupancy = step.occupancy;
        if !M || (traffic.is_empty() && self.in_flight.is_empty()) {
            self.deliver(start + step.latency, mask, step.ends_frame, outputs);
        } else {
            let mut flight = InFlight::new(start + step.latency, mask, step.ends_frame);
            occupancy = occupancy.max(self.issue(start, &mut flight, clients, traffic));
            traffic.clear();
            if !self.in_flight.is_empty() || !self.land(&mut flight, outputs, clients) {
                self.take_off(flight);
                if self.in_flight.len() == 1 {
                    self.keep_answers(clients);
                }
            }
        }
        self.account.busy += occupancy;
        self.free = start + occupancy;
        self.steps += 1;
    }

    /// Issues a step's look-ups and requests; returns the least occupancy that its look-ups need (law 5).
    fn issue<const M: bool>(
        &mut self,
        start: Cycle,
        flight: &mut InFlight,
        clients: &mut Clients<'_, M>,
        traffic: &Traffic,
    ) -> u64 {
        let ids = clients.ids();
        let Some(system) = clients.system_mut() else { return 1 };
        for (i, &client) in ids.iter().enumerate() {
            flight.served[i] = system.served(client);
        }
        for r in &traffic.look_ups {
            let client = ids[r.client as usize];
            let line_bytes = system.line_bytes(client);
            let (first, last) = (r.address / line_bytes, (r.address + u64::from(r.bytes.max(1)) - 1) / line_bytes);
            for line in first..=last {
                self.look_up(system, client, start, line, (r.client as usize, flight));
            }
        }
        for r in &traffic.requests {
            let number = system.issue(ids[r.client as usize], start, r.address, r.bytes, r.write);
            if !r.write {
                flight.reads[r.client as usize] = number + 1;
            }
        }
        let mut least = 1;
        for (i, &client) in ids.iter().enumerate() {
            let lines = u64::from(flight.look_ups[i]);
            least = least.max(lines.div_ceil(system.lookups_per_cycle(client)));
            system.serve_if_private(client);
        }
        least
    }

    /// Looks a line up unless this step has done so before (distinct lines, in order of first mention).
    #[inline]
    fn look_up(
        &mut self,
        system: &mut crate::MemorySystem,
        client: usize,
        start: Cycle,
        line: u64,
        (i, flight): (usize, &mut InFlight),
    ) {
        let mine = flight.look_ups[i] as usize;
        let queue = &mut self.look_ups[i];
        if queue.iter().rev().take(mine).any(|l| l.line == line) {
            return;
        }
        queue.push_back(system.look_up(client, start, line));
        flight.look_ups[i] += 1;
    }

    /// Delivers the steps in flight whose answers are known by now, and tells whether there were any. To be called
    /// before looking at the next start.
    ///
    /// A step may overtake those ahead that deliver nothing where it does, such as fragments that failed the z-test: its
    /// token must not seem to wait for their answers, or requests that it leads to would be served too late.
    #[inline]
    pub(crate) fn land_known<O: Outputs, const M: bool>(&mut self, outputs: &mut O, clients: &mut Clients<'_, M>) -> bool {
        if !M {
            return false;
        }
        let before = self.in_flight.len();
        let all = (1 << outputs.count()) - 1;
        let (mut held, mut waiting, mut i) = (0, [false; MAX_CLIENTS], 0);
        while let Some(flight) = self.in_flight.get(i).copied() {
            let mut flight = flight;
            let overtakes = flight.holds() & held == 0 && !(0..MAX_CLIENTS).any(|c| waiting[c] && flight.look_ups[c] > 0);
            if overtakes && self.land(&mut flight, outputs, clients) {
                self.in_flight.remove(i);
                continue;
            }
            held |= flight.holds();
            (0..MAX_CLIENTS).for_each(|c| waiting[c] |= flight.look_ups[c] > 0);
            self.in_flight[i] = flight;
            i += 1;
            if held & all == all {
                break;
            }
        }
        let landed = self.in_flight.len() < before;
        if landed {
            self.keep_answers(clients);
        }
        landed
    }

    /// Takes a step that waits for answers. Steps that deliver nothing wait only to be counted: those in a row wait as one.
    fn take_off(&mut self, flight: InFlight) {
        let joined = self.in_flight.back_mut().is_some_and(|last| last.holds() | flight.holds() == 0 && last.absorb(&flight));
        if !joined {
            self.in_flight.push_back(flight);
        }
    }

    /// Tells the memories which answers the oldest step in flight, and so any, may still ask for.
    fn keep_answers<const M: bool>(&self, clients: &mut Clients<'_, M>) {
        let ids = clients.ids();
        let Some(system) = clients.system_mut() else { return };
        for (i, &client) in ids.iter().enumerate() {
            system.keep_from(client, self.in_flight.front().map_or(u64::MAX, |flight| flight.served[i]));
        }
    }

    /// Delivers one step if all its answers are known.
    #[inline]
    fn land<O: Outputs, const M: bool>(&mut self, flight: &mut InFlight, outputs: &mut O, clients: &mut Clients<'_, M>) -> bool {
        let mut delivered = flight.base;
        let ids = clients.ids();
        if let Some(system) = clients.system_mut() {
            for (i, &client) in ids.iter().enumerate() {
                while flight.look_ups[i] > 0 {
                    let Some(look_up) = self.look_ups[i].front() else { break };
                    let Some(answer) = system.resolve(client, *look_up) else { return false };
                    self.look_ups[i].pop_front();
                    flight.look_ups[i] -= 1;
                    flight.answers[i] = answer;
                }
                if let Some(number) = flight.reads[i].checked_sub(1) {
                    let answer = system.answer(client, number);
                    if !answer.is_known() {
                        return false;
                    }
                    flight.answers[i] = flight.answers[i].max(answer);
                    flight.reads[i] = 0;
                }
                delivered = delivered.max(flight.answers[i]);
            }
        }
        for i in (0..outputs.count()).filter(|i| flight.mask & 1 << i != 0) {
            outputs.link_mut(i).set_awaits(&flight.answers[..ids.len()]);
        }
        self.deliver(delivered, flight.mask, flight.ends_frame, outputs);
        true
    }

    #[inline]
    fn deliver<O: Outputs>(&mut self, delivered: Cycle, mask: u32, ends_frame: bool, outputs: &mut O) {
        for i in (0..outputs.count()).filter(|i| mask & 1 << i != 0) {
            outputs.link_mut(i).deliver(delivered);
        }
        if ends_frame {
            self.frame_ends.push(delivered);
        }
    }

    /// Starts a run: tells the outputs how many clients may hold them up.
    pub(crate) fn attach<O: Outputs, const M: bool>(outputs: &mut O, clients: &Clients<'_, M>) {
        for i in 0..outputs.count() {
            outputs.link_mut(i).set_clients(clients.ids().len());
        }
    }

    /// Charges a wait to the account and shows it to the probe.
    #[inline]
    pub(crate) fn charge<P: Probe>(&mut self, probe: &mut P, stage: usize, cause: Cause, from: Cycle, to: Cycle) {
        self.account.charge(cause, to.since(from));
        if P::ON {
            probe.waited(stage, cause, from, to);
        }
    }
}
