//! `timed`: every stage advances as far as its inputs, outputs and credits are known. If no stage can advance, the
//! memories make the choices that no later event can change. The cost is O(tokens x stages), whatever the cycles.
//!
//! # Why its reports equal those of `ticked`
//!
//! Each invariant holds before and after every visit of a stage. Each names the code that maintains it and the tests that fail
//! without it.
//!
//! 1. **The work of a step does not depend on time.** It is a function of the unit's state and of the tokens that the unit declared
//!    from its state. Tokens of one FIFO come in order, from one producer to one consumer. So the steps of a unit, and the
//!    tokens on each FIFO, are the same in any order of visits. [`Unit::step`](crate::Unit::step) receives no cycle;
//!    [`check_wiring`](crate::check_wiring) finds a FIFO with two producers or consumers. Tests `laws/law_6_contents`,
//!    `wiring::fifo_has_one_producer_and_one_consumer`.
//! 2. **A known time is final.** Visible, popped and answer times are written once, when all their inputs are known. An unknown time is
//!    later than any known time. `FifoTiming::deliver`, `FifoTiming::pop`, `Memory::serve`; `Cycle::UNKNOWN`. Tests
//!    `laws/law_1_fifo`, `laws/law_2_slots`.
//! 3. **A known start is the earliest** (law 3). It is the maximum of four kinds of known times. Each is final by 2 and, once
//!    passed, stays passed until the step starts. The time at which a blocking step frees its unit is unknown until its answers are
//!    known. `MachineTiming::next_start`; for the causes of the wait
//!    `MachineTiming::split_wait`. Tests `laws/law_3_start`, `laws/law_9_accounting`.
//! 4. **Requests of a client arrive in order of time.** They arrive while their step occupies its stage, in order of issue, so the queue
//!    of a port is sorted. This needs one stage per client, requests to that stage's clients only, and credits for the largest
//!    step; otherwise a start would be known too early or never. `check_wiring`; `MemoryPorts::settle` refuses other requests.
//!    Tests `wiring::memory_client_exists_and_belongs_to_one_stage`, `wiring::largest_step_has_enough_credits`,
//!    `wiring::request_to_missing_client_is_a_fault`, `wiring::step_beyond_largest_is_a_fault`.
//! 5. **A served choice is final.** A request that arrives at *h* or later comes into view at *h* + 1 at the earliest, and is served
//!    there at the earliest. So if no unknown request arrives before *h*, a memory may serve every burst whose column command is at
//!    *h* + 1 or before, all bursts while its window is full, and its oldest burst once that has been passed over `cap` times.
//!    `Channel::serve`. A memory that only one stage uses gets no request before that stage is free again.
//!    `MemorySystem::find_private`, `StageVisit::serve_private`. Requests of periodic clients are known in advance and bound no horizon.
//!    They are taken in together with the requests of units (`Memory::serve_among_periodic`). Tests `laws/law_4_memory`, `vectors`.
//! 6. **Promises are kept.** A stage that promised *p* makes no step before *p*. Each input and output that it waits for comes no earlier
//!    than the promise of the stage at the other end plus the latency between. So the least promise of a memory's
//!    users is such an *h*. A blocked stage makes no step before the earliest answer that the memory of an unanswered client can still give
//!    (`InFlightSteps::no_release_before`). `StageVisit::promise`, `MemorySystem::serve_promised`, `StageVisit::serve_awaited`. Test
//!    `properties::both_engines_give_equal_reports`.
//! 7. **If nothing moves, no request can arrive before the horizon.** Every stage with further steps waits, through
//!    some chain of FIFOs and credits, for an answer to a waiting request. The horizon is the earliest possible such answer:
//!    the least latency after the first column command that a memory can still issue. Therefore a delivery must not seem to
//!    wait for an answer on which it does not depend: `InFlightSteps::deliver_known` lets steps overtake earlier steps that emit
//!    nothing or emit elsewhere. `MemorySystem::serve_safe`. Tests `hidden_deliveries`, `in_flight`.
//! 8. **The engine terminates.** An answer comes at least one cycle after its column command, so the burst that sets the horizon is
//!    served, or its request is split into bursts. Each round makes a step, advances a memory, or is the last. Test `laws/law_8_end`.
//! 9. **A skipped stage could do nothing.** A visit depends on the stage itself and on four inputs: its front token is visible, its
//!    full FIFO has room, the promises while neither is so, and its number of served requests. Each input sets a news flag when it
//!    changes. A stage that a limit or the end of a recording holds back is visited in any case, and so is a stage that an
//!    answer has freed. A visit lands all its steps in flight
//!    before it ends. `FifoTiming::news`, `StageVisit::has_news`. Without the flags two of three visits found nothing. Tests
//!    `properties::both_engines_give_equal_reports`, `hidden_deliveries`.
//!
//! Rejected: promises that are renewed only when no stage moves, in one pass over all FIFOs. No visit then serves only a promise, but
//! memories serve in smaller pieces: W4 took 2 to 5 % fewer instructions, W6 9 to 17 % more.
//!
//! By 1 both engines make the same steps. By 2, 3 and 5 to 7 the steps have the same times, and all requests are served in the order
//! of law 4. By 8 both engines end in a state in which no step can start. So their reports are equal.

use super::context::{ActiveRecording, RunLimits, fault_of, report_progress};
use super::step_source::{StepSource, UnitSteps};
use crate::bound_stage::BoundStage;
use crate::machine::{Machine, Visitor};
use crate::netlist::Netlist;
use crate::probe::NoProbe;
use crate::time::{InputMask, MachineTiming, PathTracer, StageArity, StageVisit, StopReason};
use crate::{Cycle, MemoryPorts, Probe};

/// One round over all stages.
pub(super) struct RunAhead<'a, SomeProbe> {
    pub(super) time: &'a mut MachineTiming,
    pub(super) round: Round<'a, SomeProbe>,
}

/// A round apart from the times: its limits, its outputs, and its findings so far.
pub(super) struct Round<'a, SomeProbe> {
    pub(super) probe: &'a mut SomeProbe,
    traffic: MemoryPorts,
    end: Cycle,
    pub(super) stage: usize,
    moved: bool,
    pub(super) limited: bool,
    pub(super) fault: Option<String>,
    /// True if a stage is ready but its next recorded step has not arrived.
    pub(super) needs_more_steps: bool,
    /// True if there are memories, so that promises are useful.
    promises: bool,
    accounts_for: bool,
    /// The recording, if one is made.
    pub(super) recording: Option<ActiveRecording<'a>>,
    /// The wait of every step, if the critical path is wanted.
    pub(super) path: Option<PathTracer>,
}

impl<'a, SomeProbe: Probe> RunAhead<'a, SomeProbe> {
    pub(super) fn new(
        time: &'a mut MachineTiming,
        probe: &'a mut SomeProbe,
        max_cycles: u64,
        recording: Option<ActiveRecording<'a>>,
    ) -> Self {
        time.limit = Cycle(max_cycles);
        let (promises, accounts_for) = (time.memories.has_any(), time.accounts_for);
        let (traffic, end, fault) = (MemoryPorts::default(), Cycle(max_cycles), None);
        let (stage, moved, limited, needs_more_steps) = (0, false, false, false);
        let round = Round {
            probe,
            traffic,
            end,
            stage,
            moved,
            limited,
            fault,
            needs_more_steps,
            promises,
            accounts_for,
            recording,
            path: None,
        };
        Self { time, round }
    }

    /// Begins a round.
    pub(super) fn begin(&mut self) {
        let Round { stage, moved, limited, needs_more_steps, .. } = &mut self.round;
        (*stage, *moved, *limited, *needs_more_steps) = (0, false, false, false);
    }

    /// Ends a round: memories serve what is promised or safe. Returns true if anything moved.
    pub(super) fn goes_on(&mut self) -> bool {
        let Self { time, round } = self;
        let served = time.memories.serve_promised();
        round.moved || served || (!round.needs_more_steps && time.memories.serve_safe())
    }

    /// Advances a stage as far as possible.
    #[inline(always)]
    pub(super) fn advance<K: StageArity, W: StepSource>(&mut self, number: usize, work: &mut W) {
        let Self { time, round } = self;
        let (mut visit, mut shape) = time.visit::<K>(number);
        if !visit.has_news::<K>() {
            return;
        }
        round.moved |= visit.deliver_known_steps::<K>();
        loop {
            let takes = round.fire_known::<K, W>(&mut visit, shape, work);
            if visit.must_grow::<K>() {
                time.grow_outputs(number);
                (visit, shape) = time.visit::<K>(number);
                continue;
            }
            round.moved |= visit.deliver_known_steps::<K>();
            if !round.promises {
                break;
            }
            let start = visit.promise::<K>(takes);
            if !visit.serve_private::<K>(start) && !visit.serve_awaited::<K>() {
                break;
            }
            round.moved = true;
            visit.deliver_known_steps::<K>();
        }
        visit.end_visit::<K>();
    }
}

impl<SomeProbe: Probe> Round<'_, SomeProbe> {
    /// Executes all steps of a stage whose starts are known.
    #[inline(always)]
    fn fire_known<K: StageArity, W: StepSource>(
        &mut self,
        visit: &mut StageVisit<'_>,
        shape: &Netlist,
        work: &mut W,
    ) -> InputMask {
        let Self { probe, traffic, recording, path, accounts_for, .. } = self;
        let number = visit.stage;
        loop {
            let (declared, takes) = work.next();
            let at = visit.next_start::<K>(takes);
            if at >= self.end {
                let is_known = at.is_known();
                self.limited |= is_known;
                visit.clock.again = is_known;
                return takes;
            }
            if !work.has_step() {
                (self.needs_more_steps, visit.clock.again) = (true, true);
                return takes;
            }
            if at > visit.clock.free && *accounts_for {
                visit.charge_wait::<K, _>(takes, at, *probe);
            }
            let made = work.step(declared, traffic);
            if SomeProbe::is_on() {
                work.report_step(number, declared, &made, traffic, &mut **probe);
            }
            W::trace::<K>(path, visit, at, takes, made.marked);
            if work.is_silent(traffic) {
                visit.step::<K>(at, takes, &made);
            } else {
                let asks = work.requests(traffic, visit);
                visit.step_asking::<K>(at, takes, &made, asks);
            }
            if let Some(recording) = recording {
                work.write(recording.writer, number, declared, &made, traffic);
            }
            work.go_on(traffic);
            self.moved = true;
            let free = visit.clock.free;
            if SomeProbe::is_on() {
                probe.on_busy(number, at, free);
            }
            if traffic.fault.is_some() {
                self.fault = fault_of(traffic, &shape.stages[number].names.name, Some(at));
                self.end = Cycle::ZERO;
                return takes;
            }
            if visit.serve_private::<K>(free) {
                visit.deliver_known_steps::<K>();
            }
        }
    }
}

impl Visitor for RunAhead<'_, NoProbe> {
    #[inline]
    fn stage<P: BoundStage>(&mut self, mut place: P) {
        let (stage, connections) = place.open();
        let number = self.round.stage;
        self.round.stage += 1;
        let work = &mut UnitSteps::new(stage, connections);
        self.advance::<UnitSteps<'_, P::Unit, P::Inputs, P::Outputs, P::Clients>, _>(number, work);
    }
}

/// Runs a machine without a probe.
pub(super) fn run<M: Machine>(
    machine: &mut M,
    time: &mut MachineTiming,
    limits: RunLimits<'_, M>,
    recording: Option<ActiveRecording<'_>>,
) -> StopReason {
    let (probe, recording) = (&mut NoProbe, recording.map(ActiveRecording::shortened));
    run_rounds(machine, RunAhead::new(time, probe, limits.max_cycles, recording), limits, M::wire)
}

/// Runs a machine to its end. `round`: makes one round over all stages.
pub(super) fn run_rounds<'a, M: Machine, P: Probe>(
    machine: &mut M,
    mut walk: RunAhead<'a, P>,
    limits: RunLimits<'_, M>,
    round: impl Fn(&mut M, &mut RunAhead<'a, P>),
) -> StopReason {
    for number in 1_u64.. {
        walk.begin();
        round(machine, &mut walk);
        if let Some(fault) = walk.round.fault {
            return StopReason::Fault(fault);
        }
        if !walk.goes_on() {
            break;
        }
        walk.time.show_fills(walk.round.probe, None);
        if (number.is_multiple_of(16) || machine.has_news())
            && !report_progress(machine, walk.time, &mut walk.round.recording, limits.progress)
        {
            return StopReason::Stopped;
        }
    }
    walk.time.land_all();
    if walk.round.limited { StopReason::Limit(limits.max_cycles) } else { StopReason::Quiet }
}
