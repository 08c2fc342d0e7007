//! A stage being advanced: its clock with its FIFOs and memories. The connections do not change during a visit, so they are
//! looked up once and not in every step.

use super::blocking_wait::BlockingWait;
use super::in_flight::{BLOCKING, Delivery, InFlightStep, MARKED};
use super::port_ids::{ConnectedFifos, PortIds};
use super::stage_clock::StepAnswers;
use super::{FifoTiming, InputMask, StageArity, StageClock, StepTiming, charge};
use crate::step_requests::{StepRequestsView, UnitRequests};
use crate::{Cycle, CycleAccount, MemoryClients, MemoryPorts, MemorySystem, Probe};

/// A stage with mutable timing state.
pub(crate) struct StageVisit<'a> {
    pub(crate) stage: usize,
    pub(crate) clock: &'a mut StageClock,
    pub(super) account: &'a mut CycleAccount,
    pub(super) fifos: &'a [FifoTiming],
    pub(super) memories: &'a mut MemorySystem,
    pub(super) inputs: ConnectedFifos<'a>,
    pub(super) outputs: ConnectedFifos<'a>,
}

impl StageVisit<'_> {
    /// Returns true if any input of its timing has changed since the last visit. Otherwise a visit can do nothing new.
    #[inline(always)]
    pub(crate) fn has_news<K: StageArity>(&mut self) -> bool {
        let Self { clock, inputs, outputs, memories, .. } = self;
        let mut news = std::mem::take(&mut clock.again);
        inputs.each(inputs.all(K::INPUTS), K::INPUTS, |_, fifo| news |= fifo.has_news_for_consumer());
        outputs.each(outputs.all(K::OUTPUTS), K::OUTPUTS, |_, fifo| news |= fifo.has_news_for_producer());
        news || (K::HAS_MEMORY && clock.served != memories.served_of(&clock.clients))
    }

    /// Returns true if the stage may have stopped because an output must [grow](FifoTiming::grow).
    #[inline(always)]
    pub(crate) fn must_grow<K: StageArity>(&self) -> bool {
        let mut must_grow = false;
        self.outputs.each(self.outputs.all(K::OUTPUTS), K::OUTPUTS, |_, fifo| must_grow |= fifo.must_grow());
        must_grow
    }

    /// Ends the visit. Requests served by now are not news.
    #[inline(always)]
    pub(crate) fn end_visit<K: StageArity>(&mut self) {
        if K::HAS_MEMORY {
            self.clock.served = self.memories.served_of(&self.clock.clients);
        }
    }

    /// Returns the earliest start of its next step (law 3); unknown while it depends on an unknown time, and if there is no
    /// further step.
    #[inline(always)]
    pub(crate) fn next_start<K: StageArity>(&self, takes: InputMask) -> Cycle {
        self.clock.next_start::<K>(&self.inputs, &self.outputs, self.memories, takes)
    }

    /// Charges the wait from the end of its last step to the start of the next, at `at`.
    #[inline(always)]
    pub(crate) fn charge_wait<K: StageArity, P: Probe>(&mut self, takes: InputMask, at: Cycle, probe: &mut P) {
        let Self { stage, clock, account, memories, inputs, outputs, .. } = self;
        let interval = clock.free..at;
        clock.split_wait::<K>(inputs, outputs, memories, takes, interval, |wait| charge(account, probe, *stage, wait));
    }

    /// Returns the memory requests of a step: see [`MemoryPorts::settle`].
    #[inline(always)]
    pub(crate) fn settle<'t>(&mut self, traffic: &'t mut MemoryPorts) -> Option<StepRequestsView<'t>> {
        let StageClock { clients, needs, .. } = &*self.clock;
        traffic.settle(&mut MemoryClients { ids: clients, memories: self.memories }, &needs.credits)
    }

    /// As `settle`, for a step whose requests are not in its ports.
    #[inline(always)]
    pub(crate) fn settle_stored<'t>(
        &mut self,
        asks: UnitRequests<'t>,
        traffic: &'t mut MemoryPorts,
    ) -> Option<StepRequestsView<'t>> {
        let StageClock { clients, needs, .. } = &*self.clock;
        traffic.settle_stored(asks, &mut MemoryClients { ids: clients, memories: self.memories }, &needs.credits)
    }

    /// Makes a step without requests that starts at `at`: updates the times of its FIFOs. Its delivery is known.
    #[inline(always)]
    pub(crate) fn step<K: StageArity>(&mut self, at: Cycle, takes: InputMask, made: &StepTiming) {
        let (occupancy, latency) = self.take_and_reserve::<K>(at, takes, made);
        if K::HAS_MEMORY && !self.clock.flights.is_empty() {
            let delivery = Delivery { base: at.after(latency), after_data: 0, outputs: outputs_and_mark(made) };
            let clients = &mut MemoryClients { ids: &self.clock.clients, memories: self.memories };
            self.clock.flights.push(InFlightStep::new(self.clock.steps, delivery), clients);
            return self.occupy(at, occupancy);
        }
        self.outputs.each(made.outputs, K::OUTPUTS, |_, fifo| fifo.deliver(at.after(latency)));
        if made.marked {
            self.clock.marks.push(at.after(latency));
        }
        self.occupy(at, occupancy);
    }

    /// Makes a step with requests. With `None`, because the requests contradict the declaration or the wiring, it delivers
    /// nothing, and the run ends there.
    #[inline(always)]
    pub(crate) fn step_asking<K: StageArity>(
        &mut self,
        at: Cycle,
        takes: InputMask,
        made: &StepTiming,
        asks: Option<StepRequestsView<'_>>,
    ) {
        let (occupancy, _) = self.take_and_reserve::<K>(at, takes, made);
        let least = asks.map_or(1, |asks| issue_step(self.clock, self.fifos, self.memories, at, made, asks));
        self.occupy(at, occupancy.max(least));
    }

    /// Takes tokens and reserves slots. Returns occupancy and latency, as far as no memory decides.
    #[inline(always)]
    fn take_and_reserve<K: StageArity>(&mut self, at: Cycle, takes: InputMask, made: &StepTiming) -> (u64, u64) {
        if K::HAS_MEMORY {
            self.clock.needs.asked = false;
        }
        self.inputs.each(takes.inputs(), K::INPUTS, |_, fifo| fifo.pop(at));
        self.outputs.each(made.outputs, K::OUTPUTS, |_, fifo| fifo.reserve(at));
        self.clock.known_timing(made)
    }

    #[inline(always)]
    fn occupy(&mut self, at: Cycle, occupancy: u64) {
        self.clock.busy += occupancy;
        self.clock.free = at.after(occupancy);
        self.clock.steps += 1;
    }

    /// Delivers the steps in flight whose answers are known by now. Returns true if there was any. Call it before `next_start`.
    ///
    /// A step may overtake earlier steps that deliver nothing on its outputs, such as tokens that a test discards. Its token must
    /// not seem to wait for their answers, or the requests that it causes would be served too late.
    #[inline(always)]
    pub(crate) fn deliver_known_steps<K: StageArity>(&mut self) -> bool {
        K::HAS_MEMORY && !self.clock.flights.is_empty() && deliver_known(self.clock, self.fifos, self.memories)
    }

    /// Promises that it makes no step before its earliest possible start, which builds on the promises of its neighbours. The
    /// neighbours build on this promise in turn, and its memories serve requests of others up to it.
    #[inline(always)]
    pub(crate) fn promise<K: StageArity>(&mut self, takes: InputMask) -> Cycle {
        let Self { clock, memories, inputs, outputs, .. } = self;
        let mut start = if takes == InputMask::NO_STEP { Cycle::UNKNOWN } else { clock.free };
        if K::HAS_MEMORY && clock.block.until > clock.free {
            start = start.max(clock.no_release_before(memories));
        }
        let (taken, room) = (takes.inputs(), outputs.all(K::OUTPUTS));
        inputs.each(taken, K::INPUTS, |_, fifo| start = start.max(fifo.no_front_before()));
        outputs.each(room, K::OUTPUTS, |_, fifo| start = start.max(fifo.no_room_before()));
        inputs.each(inputs.all(K::INPUTS), K::INPUTS, |_, fifo| fifo.promise_pop(start));
        outputs.each(room, K::OUTPUTS, |_, fifo| fifo.promise_push(start));
        if K::HAS_MEMORY {
            clock.clients.iter().for_each(|&client| memories.promise(client, start));
        }
        start
    }

    /// Serves final choices of the memories that only this stage uses, if it makes no step before `horizon`. Returns true if
    /// there was any.
    #[inline(always)]
    pub(crate) fn serve_private<K: StageArity>(&mut self, horizon: Cycle) -> bool {
        let Self { clock, memories, .. } = self;
        K::HAS_MEMORY
            && clock.has_private
            && clock.clients.iter().fold(false, |any, &client| memories.serve_if_private(client, horizon) | any)
    }

    /// Serves choices for which a blocking step waits, as far as they are final by the promises so far. Returns true if there was any.
    /// So a unit that waits for one datum after the other needs no round for each.
    #[inline]
    pub(crate) fn serve_awaited<K: StageArity>(&mut self) -> bool {
        let Self { clock, memories, .. } = self;
        K::HAS_MEMORY
            && !clock.block.until.is_known()
            && clock.clients.iter().fold(false, |any, &client| memories.serve_promised_of(client) | any)
    }
}

/// Returns the outputs of a step, with the bit [`MARKED`].
#[inline(always)]
fn outputs_and_mark(made: &StepTiming) -> u32 {
    made.outputs | if made.marked { MARKED } else { 0 }
}

/// Issues the requests of a step that starts at `start`, and delivers the step if all answers are known. Returns the least
/// occupancy that its requests need. (This function and the next are not methods: with a reference to the visit, all of the visit
/// would have to be in memory.)
fn issue_step(
    clock: &mut StageClock,
    fifos: &[FifoTiming],
    memories: &mut MemorySystem,
    start: Cycle,
    made: &StepTiming,
    asks: StepRequestsView<'_>,
) -> u64 {
    let (base, after_data) = (start.after(clock.known_timing(made).1), made.after_data);
    let outputs = outputs_and_mark(made) | if made.blocking { BLOCKING } else { 0 };
    let mut flight = InFlightStep::new(clock.steps, Delivery { base, after_data, outputs });
    let StageClock { flights, clients, needs, marks, outputs, block, answers, .. } = clock;
    let clients = &mut MemoryClients { ids: clients, memories };
    if !made.blocking
        && let Some(least) = flights.hit(&mut flight, start, clients, asks)
    {
        deliver_answered(marks, block, answers, *outputs, &flight, flight.delivery.outputs, fifos);
        return least;
    }
    needs.asked = asks.issue_any();
    let issued = flights.issue(&mut flight, start, clients, asks);
    if !issued.awaits {
        flight.delivery.after_data = 0;
        flight.delivery.outputs &= !BLOCKING;
    } else if flight.is_blocking() {
        block.begin(issued.order);
    }
    if issued.at_once {
        deliver_answered(marks, block, answers, *outputs, &flight, flight.delivery.outputs, fifos);
    } else {
        flights.push(flight, clients);
    }
    issued.least
}

fn deliver_known(clock: &mut StageClock, fifos: &[FifoTiming], memories: &mut MemorySystem) -> bool {
    let StageClock { flights, marks, clients, outputs, block, answers, again, .. } = clock;
    let is_blocked = !block.until.is_known();
    let all = outputs.all() | if is_blocked { BLOCKING } else { 0 };
    let moved = flights.deliver_known(all, &mut MemoryClients { ids: clients, memories }, |flight, to| {
        deliver_answered(marks, block, answers, *outputs, flight, to, fifos);
    });
    *again |= is_blocked && block.until.is_known();
    moved
}

/// Delivers an answered step to these outputs.
#[inline(always)]
fn deliver_answered(
    marks: &mut Vec<Cycle>,
    block: &mut BlockingWait,
    answers: &mut Option<Vec<StepAnswers>>,
    outputs: PortIds,
    flight: &InFlightStep,
    to: u32,
    fifos: &[FifoTiming],
) {
    let at = flight.delivered();
    if let Some(answers) = answers {
        answers.push((flight.step, flight.answers));
    }
    for (_, fifo) in outputs.of(to & outputs.all()) {
        fifos[fifo].set_awaits(flight.answers);
        fifos[fifo].deliver(at);
    }
    if to & MARKED != 0 {
        marks.push(at);
    }
    if to & BLOCKING != 0 {
        block.release(flight.answers);
    }
}
