//! `ticked`: every unit in every cycle. It determines the cause of a wait cycle by cycle and counts the slots in use at the end
//! of each cycle. `timed` does both by intervals.
//!
//! It shares with `timed` the start times of steps (`MachineTiming::next_start`), the causes of waits
//! (`MachineTiming::split_wait`), the execution of steps, the steps in flight, the FIFOs and the memories. So it is the reference
//! for the *order* of events and for sums over intervals. It cannot detect an error in the shared parts. For those there is an
//! independent implementation of the laws that shares no code with this crate. `basrelief-kernel-conformance` compares both
//! engines with its results: `tests/vectors/laws.jsonl` has one plan and its result per line, and `tests/suite/vectors.rs` checks them.
//! To compare with another implementation, run it on the `plan` of each line. `examples/plan.rs` runs one plan, or a folder of
//! such vectors, from the command line.

use super::context::{ActiveRecording, RunLimits, fault_of, report_progress};
use super::step_source::{StepSource, UnitSteps};
use crate::account::Wait;
use crate::bound_stage::BoundStage;
use crate::machine::{Machine, Visitor};
use crate::time::{AnyArity, FifoTiming, MachineTiming, StopReason, charge};
use crate::{Cycle, Demand, MemoryPorts, Probe, Unit};

/// One cycle of all stages. The probe stands behind a pointer: this engine need not be fast, and so it is compiled once for all probes.
struct TickedCycle<'a> {
    time: &'a mut MachineTiming,
    probe: &'a mut dyn Probe,
    traffic: MemoryPorts,
    now: Cycle,
    stage: usize,
    fired: bool,
    fault: Option<String>,
    /// Waits of each stage since its last step.
    waits: Vec<Vec<Wait>>,
    /// The recording, if one is made.
    recording: Option<ActiveRecording<'a>>,
}

impl TickedCycle<'_> {
    /// Executes a step that starts now.
    fn execute_step(&mut self, number: usize, demand: Demand, work: &mut impl StepSource<Declared = Demand>) {
        for wait in self.waits[number].drain(..) {
            charge(&mut self.time.accounts[number], &mut self.probe, number, wait);
        }
        let takes = self.time.stages[number].inputs_of(demand);
        let made = work.step(demand, &mut self.traffic);
        work.report_step(number, demand, &made, &self.traffic, self.probe);
        let (mut visit, _) = self.time.visit::<AnyArity>(number);
        let asks = work.requests(&mut self.traffic, &mut visit);
        visit.step_asking::<AnyArity>(self.now, takes, &made, asks);
        if let Some(recording) = &mut self.recording {
            work.write(recording.writer, number, demand, &made, &self.traffic);
        }
        work.go_on(&mut self.traffic);
        self.fired = true;
        self.probe.on_busy(number, self.now, self.time.stages[number].free);
        if self.traffic.fault.is_some() && self.fault.is_none() {
            let name = &self.time.shape.stages[number].names.name;
            self.fault = fault_of(&mut self.traffic, name, Some(self.now));
        }
    }

    /// Counts one cycle of waiting.
    fn record_wait(&mut self, number: usize, demand: Demand) {
        let waits = &mut self.waits[number];
        self.time.split_wait(number, demand, self.now..self.now + 1, |wait| merge_wait(waits, wait));
    }
}

impl Visitor for TickedCycle<'_> {
    fn stage<P: BoundStage>(&mut self, mut place: P) {
        let (stage, connections) = place.open();
        let number = self.stage;
        self.stage += 1;
        let demand = stage.unit.demand();
        let clock = &self.time.stages[number];
        if clock.free > self.now || (demand == Demand::Finished && clock.released() <= self.now) {
            return;
        }
        self.time.grow_outputs(number);
        if self.time.next_start(number, demand) <= self.now {
            let mut steps = UnitSteps::new(stage, connections);
            self.execute_step(number, demand, &mut steps.behind_pointer());
        } else {
            self.record_wait(number, demand);
        }
    }
}

fn merge_wait(waits: &mut Vec<Wait>, wait: Wait) {
    match waits.last_mut() {
        Some(last) if last.cause == wait.cause && last.to == wait.from => last.to = wait.to,
        _ => waits.push(wait),
    }
}

/// Records the known answers that slots wait for. `timed` asks when all are known, but this engine asks in every cycle.
fn record_awaits(time: &mut MachineTiming) {
    let MachineTiming { stages, fifos, memories, .. } = time;
    stages.iter_mut().for_each(|clock| clock.record_awaits(fifos, memories));
}

/// Finds out if any stage has a known next start.
struct AnyStart<'a> {
    time: &'a MachineTiming,
    stage: usize,
    any: bool,
}

impl Visitor for AnyStart<'_> {
    fn stage<P: BoundStage>(&mut self, mut place: P) {
        let (stage, _) = place.open();
        self.any |= self.time.next_start(self.stage, stage.unit.demand()).is_known();
        self.stage += 1;
    }
}

pub(super) fn run<M: Machine>(
    machine: &mut M,
    time: &mut MachineTiming,
    probe: &mut dyn Probe,
    limits: RunLimits<'_, M>,
    recording: Option<ActiveRecording<'_>>,
) -> StopReason {
    time.memories.share_all();
    time.limit = Cycle(limits.max_cycles);
    let (traffic, waits) = (MemoryPorts::default(), vec![Vec::new(); time.stages.len()]);
    let recording = recording.map(ActiveRecording::shortened);
    let mut tick = TickedCycle { time, probe, traffic, now: Cycle::ZERO, stage: 0, fired: false, fault: None, waits, recording };
    loop {
        if tick.now.0 >= limits.max_cycles {
            // No request is still to come.
            tick.time.memories.serve_before(Cycle::UNKNOWN);
            tick.time.land_all();
            let mut starts = AnyStart { time: &*tick.time, stage: 0, any: false };
            machine.wire(&mut starts);
            if starts.any {
                return StopReason::Limit(limits.max_cycles);
            }
            // No further step will start. Steps that have started run out and are counted.
        }
        (tick.stage, tick.fired) = (0, false);
        machine.wire(&mut tick);
        if let Some(fault) = tick.fault {
            return StopReason::Fault(fault);
        }
        let time = &mut *tick.time;
        time.memories.serve_before(tick.now + 1);
        // The last cycle of the events that are already decided.
        let busy = time.stages.iter().map(|clock| clock.free).max();
        let visible = time.fifos.iter().filter_map(FifoTiming::last_visible).max();
        time.land_all();
        let released = time.stages.iter().map(|clock| clock.block.until).filter(|until| until.is_known()).max();
        record_awaits(time);
        time.fifos.iter_mut().for_each(|fifo| fifo.count_held(tick.now));
        let horizon = busy.max(visible).max(released).unwrap_or_default().max(time.memories.last_answer());
        if !tick.fired && horizon <= tick.now && time.memories.is_idle() && time.last_mark() <= tick.now {
            return StopReason::Quiet;
        }
        tick.now = tick.now + 1;
        if !tick.now.0.is_multiple_of(4096) && !machine.has_news() {
            continue;
        }
        // Changes that may come after the end wait until the end is known.
        if tick.now.0 <= tick.time.known_total() {
            tick.time.show_fills(&mut tick.probe, None);
        }
        if !report_progress(machine, tick.time, &mut tick.recording, limits.progress) {
            return StopReason::Stopped;
        }
    }
}
