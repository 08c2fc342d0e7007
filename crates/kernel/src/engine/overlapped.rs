//! A run in two halves, which may be on two threads: one executes the steps, the other computes their times. The work of a step
//! does not depend on time (law 6), so the first half never waits for a result of the second.

use super::arity::{advance, run_stored_steps};
use super::batch::{BatchedStep, StageSteps, StepBatch};
use super::context::ActiveRecording;
use super::functional::run_to;
use super::step_source::StepSource;
use super::timed::RunAhead;
use crate::check::WiringError;
use crate::machine::Machine;
use crate::netlist::Netlist;
use crate::probe::NoProbe;
use crate::recording::{RecordingChunk, RecordingWriter};
use crate::report::RunReport;
use crate::step_requests::{StepRequestsView, UnitRequests};
use crate::time::{FinalUnitState, InputMask, MachineTiming, StageVisit, StepTiming, StopReason};
use crate::{Demand, MemoryPorts};
use std::collections::VecDeque;

/// Executes all steps of a machine and passes them on in batches of some `steps` steps. Execution runs ahead of timing, so it
/// suits runs without a cycle limit. `progress` as in [`RunLimits`](super::RunLimits).
///
/// # Errors
/// If the wiring is invalid.
pub fn make_steps<M: Machine>(
    machine: &mut M,
    progress: &mut dyn FnMut(&mut M) -> bool,
    steps: usize,
    hand_on: &mut dyn FnMut(StepBatch),
) -> Result<(), WiringError> {
    let stages = Netlist::of(machine)?.stages.len();
    run_to(machine, progress, steps, vec![StageSteps::default(); stages], hand_on);
    Ok(())
}

/// Computes the times of the steps of a machine with this netlist, batch by batch. Returns the report that
/// [`run_with`](super::run_with) gives with the timed engine. `keep` receives the [recording](crate::recording), in chunks of
/// about so many bytes.
pub fn time_steps(
    shape: Netlist,
    batches: &mut dyn FnMut() -> Option<StepBatch>,
    keep: Option<(usize, &mut dyn FnMut(RecordingChunk))>,
) -> RunReport {
    let mut time = MachineTiming::new(shape);
    let inputs = time.shape.stages.iter().map(|stage| stage.inputs.len());
    let mut queues: Vec<BatchedSteps> = inputs.map(BatchedSteps::new).collect();
    let mut recording = keep.map(|(bytes, keep)| (RecordingWriter::new(&time.shape, &time.memories, bytes), keep));
    let active = recording.as_mut().map(|(writer, keep)| ActiveRecording { writer, keep: &mut **keep });
    let halt = compute_times(&mut time, &mut NoProbe, &mut queues, batches, active);
    time.land_all();
    let unit_states = queue_states(&queues);
    if let (Some((mut writer, keep)), StopReason::Quiet) = (recording, &halt) {
        keep(writer.finish_chunk(unit_states.clone(), true));
    }
    time.finalize(&unit_states, halt, &mut NoProbe)
}

fn compute_times<'a>(
    time: &'a mut MachineTiming,
    probe: &'a mut NoProbe,
    queues: &mut [BatchedSteps],
    batches: &mut dyn FnMut() -> Option<StepBatch>,
    recording: Option<ActiveRecording<'a>>,
) -> StopReason {
    let mut stopped = feed(queues, batches).unwrap_or(true);
    let mut walk = RunAhead::new(time, probe, u64::MAX, recording);
    let after_round = |walk: &mut RunAhead<'_, NoProbe>, queues: &mut [BatchedSteps]| {
        if let Some(fault) = walk.round.fault.take() {
            return Err(StopReason::Fault(fault));
        }
        ActiveRecording::keep_chunk(&mut walk.round.recording, || queue_states(queues));
        Ok(())
    };
    let ended = run_stored_steps(&mut walk, queues, advance, after_round, |_, queues| {
        stopped = feed(queues, batches).ok_or(StopReason::Stopped)?;
        Ok(())
    });
    match ended {
        Err(reason) => reason,
        Ok(()) if stopped => StopReason::Stopped,
        Ok(()) => StopReason::Quiet,
    }
}

/// Takes the next batch, if there is one. Returns whether the run was stopped after it.
fn feed(queues: &mut [BatchedSteps], batches: &mut dyn FnMut() -> Option<StepBatch>) -> Option<bool> {
    let StepBatch { stages, unit_states, stopped } = batches()?;
    for (queue, (steps, rest)) in queues.iter_mut().zip(stages.into_iter().zip(unit_states)) {
        queue.feed(steps, rest);
    }
    Some(stopped)
}

fn queue_states(queues: &[BatchedSteps]) -> Vec<FinalUnitState> {
    queues.iter().map(BatchedSteps::rest).collect()
}

/// Steps of a stage that wait for their times.
struct BatchedSteps {
    /// The batch in use, and batches behind it. (Appending one to the other took 1.6 % of the instructions of `brick`.)
    waiting: StageSteps,
    behind: VecDeque<StageSteps>,
    /// Number of steps of the batch that were taken, and of the requests and look-ups before the last of them.
    next: usize,
    asked: [usize; 2],
    /// Number of requests and look-ups of the last of them.
    asks: [u32; 2],
    /// State of the unit after these steps.
    rest: FinalUnitState,
    inputs: usize,
}

impl BatchedSteps {
    fn new(inputs: usize) -> Self {
        Self {
            waiting: StageSteps::default(),
            behind: VecDeque::new(),
            next: 0,
            asked: [0; 2],
            asks: [0; 2],
            rest: FinalUnitState { demand: Demand::Finished, empty: true },
            inputs,
        }
    }

    fn feed(&mut self, steps: StageSteps, rest: FinalUnitState) {
        self.rest = rest;
        if !steps.steps.is_empty() {
            self.behind.push_back(steps);
        }
        if !self.has_step() {
            self.use_next_batch();
        }
    }

    /// Goes on to the next batch, if there is one.
    #[cold]
    fn use_next_batch(&mut self) {
        if let Some(steps) = self.behind.pop_front() {
            (self.waiting, self.next, self.asked) = (steps, 0, [0; 2]);
        }
    }

    #[inline(always)]
    fn demand(&self) -> Demand {
        self.waiting.steps.get(self.next).map_or(self.rest.demand, |step| step.demand)
    }

    /// Returns the requests of the step just made.
    #[inline(always)]
    fn step_requests(&self) -> UnitRequests<'_> {
        self.waiting.ports.step_at(self.asked, self.asks)
    }

    fn rest(&self) -> FinalUnitState {
        FinalUnitState { demand: self.demand(), empty: self.rest.empty && !self.has_step() }
    }
}

impl StepSource for BatchedSteps {
    type Declared = Demand;

    #[inline(always)]
    fn next(&self) -> (Demand, InputMask) {
        let demand = self.demand();
        (demand, InputMask::of(demand, self.inputs))
    }

    #[inline(always)]
    fn has_step(&self) -> bool {
        self.next < self.waiting.steps.len()
    }

    #[inline(always)]
    fn step(&mut self, _: Demand, traffic: &mut MemoryPorts) -> StepTiming {
        let StageSteps { steps, ports } = &mut self.waiting;
        let BatchedStep { made, requests, look_ups, .. } = steps[self.next];
        self.asks = [requests, look_ups];
        self.next += 1;
        if self.next == steps.len()
            && let Some(fault) = ports.fault.take()
        {
            traffic.fault(fault);
        }
        made
    }

    #[inline(always)]
    fn is_silent(&self, _: &MemoryPorts) -> bool {
        self.asks == [0; 2]
    }

    #[inline(always)]
    fn requests<'a>(&'a mut self, traffic: &'a mut MemoryPorts, visit: &mut StageVisit<'_>) -> Option<StepRequestsView<'a>> {
        visit.settle_stored(self.step_requests(), traffic)
    }

    #[inline(always)]
    fn write(&self, writer: &mut RecordingWriter, number: usize, demand: Demand, made: &StepTiming, traffic: &MemoryPorts) {
        writer.step(number, demand, made, self.step_requests().requests, traffic);
    }

    #[inline(always)]
    fn go_on(&mut self, traffic: &mut MemoryPorts) {
        if self.asks != [0; 2] {
            let [requests, look_ups] = self.asks.map(|count| count as usize);
            self.asked = [self.asked[0] + requests, self.asked[1] + look_ups];
            traffic.clear();
        }
        if !self.has_step() {
            self.use_next_batch();
        }
    }
}
