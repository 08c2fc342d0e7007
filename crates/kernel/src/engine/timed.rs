//! `timed`: every stage runs ahead as far as its inputs, outputs and credits are known; when none can go on, the
//! memories make the choices that nothing still to come can change. Cost is O(tokens x stages), whatever the cycles.
//!
//! # Why it gives what `ticked` gives
//!
//! Each invariant holds before and after every visit of a stage. Named: where the code keeps it, and what fails without it.
//!
//! 1. **What a step does depends on no time.** It is a function of the unit's state and of the tokens that the unit declared
//!    from its state; tokens of one FIFO come in order, from one producer to one consumer. So the steps of a unit, and the
//!    tokens on each FIFO, are the same in whatever order stages are visited. [`Unit::step`] is given no cycle;
//!    [`check_wiring`](crate::check_wiring) finds a FIFO with two producers or consumers. Tests `laws/law_6_contents`,
//!    `wiring::a_fifo_has_one_producer_and_one_consumer`.
//! 2. **A known time is final.** Visible, popped and answer times are written once, when all they are computed from is known,
//!    and a time not known yet is later than any. `FifoTiming::deliver`, `FifoTiming::pop`, `Memory::serve`; `Cycle::UNKNOWN`. Tests
//!    `laws/law_1_fifo`, `laws/law_2_slots`.
//! 3. **A start that is known is the earliest** (law 3): the greatest of four kinds of known times, each of which is final by
//!    2 and, once passed, stays passed until the step starts. `MachineTiming::next_start`; for the causes on the way there
//!    `MachineTiming::split_wait`. Tests `laws/law_3_start`, `laws/law_9_accounting`.
//! 4. **A client's requests arrive in order of time.** They arrive at the starts of one stage's steps, which only grow; so a
//!    port's queue is sorted. It needs one stage per client, traffic to that stage's clients only, and credits for the largest
//!    step, beyond which a start would be known too early or never. `check_wiring`; `StageClock::depart` refuses other traffic.
//!    Tests `wiring::a_memory_client_belongs_to_one_stage_and_exists`, `wiring::the_largest_step_finds_credits`,
//!    `wiring::traffic_to_no_client_is_a_fault`, `wiring::a_step_beyond_the_largest_is_a_fault`.
//! 5. **A choice that is served is final.** What arrives at *h* or later comes into view at *h* + 1, and goes there at the
//!    earliest; so a memory may serve every burst whose column command goes at *h* + 1 or before, all that come while its window
//!    is full, and its oldest once that has been passed over `cap` times, if nothing unknown arrives before *h*. `Channel::serve`.
//!    A memory that one stage uses hears of nothing before that stage is free again. `MemorySystem::find_private`,
//!    `MachineTiming::serve_private`. Tests `laws/law_4_memory`, `vectors`.
//! 6. **A promise is kept.** A stage that promised *p* makes no step before *p*: every input and output it waits for is not
//!    there before what the stage at the other end has promised, plus what lies between. So the least promise of a memory's
//!    users is such an *h*. `MachineTiming::promise`, `MemorySystem::serve_promised`. Test
//!    `properties::both_engines_give_equal_reports`.
//! 7. **When nothing moves, nothing can arrive before the horizon.** Every stage that will ever step again waits, through
//!    whatever chain of FIFOs and credits, for an answer to a request that waits; the horizon is the earliest that any of those
//!    can be: the least latency after the first column command that a memory can still give. For this a delivery must not seem to
//!    wait for an answer that it does not wait for: `InFlightSteps::land` lets steps pass those ahead that emit nothing, or elsewhere.
//!    `MemorySystem::serve_safe`. Tests `hidden_deliveries`, `flights`.
//! 8. **It ends.** From a column command to its answer it takes at least a cycle, so the burst that sets the horizon is served,
//!    or the request split into bursts: each round makes a step, brings a memory on, or is the last. Test `laws/law_8_end`.
//!
//! 9. **A stage that is passed over could do nothing.** What a visit does follows from the stage itself and from what others tell it:
//!    that its front token is visible, that its full FIFO has room, what they promise where neither is so, and how many of its
//!    requests are served. Each of these leaves news where it changes, and a stage that a limit or the end of a tape holds back is
//!    visited whatever happens; what it has in flight it lands before it is left. `FifoTiming::news`, `StageVisit::has_news`. Without it two
//!    visits of three found nothing. Tests `properties::both_engines_give_equal_reports`, `hidden_deliveries`.
//!
//! By 1 both engines make the same steps; by 2, 3 and 5 to 7 at the same times, in which all requests are served in the order
//! of law 4; by 8 both come to rest, where nothing can start: so their reports are equal.

use super::context::{ActiveRecording, Limits, fault_of, look};
use super::step_source::{StepSource, UnitSteps};
use crate::bound_stage::BoundStage;
use crate::machine::{Machine, Visitor};
use crate::recording::RecordingWriter;
use crate::time::{InputMask, MachineTiming, PathTracer, StageArity, StopReason};
use crate::{Cycle, MemoryPorts, Probe};

/// One round over all stages.
pub(super) struct RunAhead<'a, SomeProbe> {
    pub(super) time: &'a mut MachineTiming,
    pub(super) probe: &'a mut SomeProbe,
    traffic: MemoryPorts,
    end: Cycle,
    stage: usize,
    moved: bool,
    pub(super) limited: bool,
    pub(super) fault: Option<String>,
    /// True if a stage is ready but its next recorded step has not arrived.
    pub(super) needs_more_steps: bool,
    /// True if there are memories, so that promises are useful.
    promises: bool,
    accounts_for: bool,
    /// The recording, if one is made.
    pub(super) tape: Option<&'a mut RecordingWriter>,
    /// The wait of every step, if the critical path is wanted.
    pub(super) path: Option<PathTracer>,
}

impl<'a, SomeProbe: Probe> RunAhead<'a, SomeProbe> {
    pub(super) fn new(
        time: &'a mut MachineTiming,
        probe: &'a mut SomeProbe,
        max_cycles: u64,
        tape: Option<&'a mut RecordingWriter>,
    ) -> Self {
        let (promises, accounts_for) = (time.memories.has_any(), time.accounts_for);
        let (traffic, end, fault) = (MemoryPorts::default(), Cycle(max_cycles), None);
        let (stage, moved, limited, needs_more_steps) = (0, false, false, false);
        Self {
            time,
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
            tape,
            path: None,
        }
    }

    /// Begins a round.
    pub(super) fn begin(&mut self) {
        (self.stage, self.moved, self.limited, self.needs_more_steps) = (0, false, false, false);
    }

    /// Ends a round: memories serve what is promised or safe. Returns true if anything moved.
    pub(super) fn goes_on(&mut self) -> bool {
        let served = self.time.memories.serve_promised();
        self.moved || served || (!self.needs_more_steps && self.time.memories.serve_safe())
    }
}

impl<SomeProbe: Probe> RunAhead<'_, SomeProbe> {
    /// Executes all steps of a stage whose starts are known.
    #[inline(always)]
    fn fire_known<K: StageArity, W: StepSource>(&mut self, number: usize, work: &mut W) -> InputMask {
        let Self { time, probe, traffic, tape, path, accounts_for, .. } = self;
        let (mut visit, shape) = time.visit::<K>(number);
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
            work.report_step(number, (declared, &made), traffic, probe);
            if let Some(path) = path {
                path.step(shape, &visit.sight(), (at, takes), &{ made });
            }
            if work.is_silent(traffic) {
                visit.step::<K>(at, takes, &made);
            } else {
                let asks = work.asks(traffic, &mut visit);
                visit.step_asking::<K>(at, takes, &made, asks);
            }
            if let Some(tape) = tape {
                work.write(tape, number, (declared, &made), traffic);
            }
            work.go_on(traffic);
            self.moved = true;
            let free = visit.clock.free;
            if SomeProbe::is_on() {
                probe.worked(number, at, free);
            }
            if traffic.fault.is_some() {
                self.fault = fault_of(traffic, &shape.stages[number].names.name, Some(at));
                self.end = Cycle::ZERO;
                return takes;
            }
            if visit.serve_private::<K>(free) {
                visit.land_known::<K>();
            }
        }
    }

    /// Advances a stage as far as possible.
    #[inline(always)]
    pub(super) fn advance<K: StageArity, W: StepSource>(&mut self, number: usize, work: &mut W) {
        let (mut visit, _) = self.time.visit::<K>(number);
        if !visit.has_news::<K>() {
            return;
        }
        self.moved |= visit.land_known::<K>();
        loop {
            let takes = self.fire_known::<K, W>(number, work);
            let (mut visit, _) = self.time.visit::<K>(number);
            self.moved |= visit.land_known::<K>();
            if !self.promises {
                break;
            }
            let start = visit.promise::<K>(takes);
            if !visit.serve_private::<K>(start) {
                break;
            }
            self.moved = true;
            visit.land_known::<K>();
        }
        self.time.visit::<K>(number).0.leave::<K>();
    }
}

impl<SomeProbe: Probe> Visitor for RunAhead<'_, SomeProbe> {
    #[inline]
    fn stage<P: BoundStage>(&mut self, mut place: P) {
        let (stage, connections) = place.open();
        let number = self.stage;
        self.stage += 1;
        let work = &mut UnitSteps::new(stage, connections);
        self.advance::<UnitSteps<'_, P::Unit, P::Inputs, P::Outputs, P::Clients>, _>(number, work);
    }
}

pub(super) fn run<M: Machine, P: Probe>(
    machine: &mut M,
    time: &mut MachineTiming,
    probe: &mut P,
    limits: Limits<'_, M>,
    recording: Option<ActiveRecording<'_>>,
) -> StopReason {
    let (tape, mut keep) = recording.map(|ActiveRecording { writer, keep }| (writer, keep)).unzip();
    let mut walk = RunAhead::new(time, probe, limits.max_cycles, tape);
    for round in 1_u64.. {
        walk.begin();
        machine.wire(&mut walk);
        if let Some(fault) = walk.fault {
            return StopReason::Fault(fault);
        }
        if !walk.goes_on() {
            break;
        }
        walk.time.show_fills(walk.probe, None);
        if (round.is_multiple_of(16) || machine.has_news())
            && !look(machine, walk.time, (&mut walk.tape, &mut keep), limits.progress)
        {
            return StopReason::Stopped;
        }
    }
    walk.time.land_all();
    if walk.limited { StopReason::Limit(limits.max_cycles) } else { StopReason::Quiet }
}
