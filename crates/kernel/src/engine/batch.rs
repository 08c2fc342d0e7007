//! Step batches: steps on their way from the half of a run that executes them to the half that computes their times.

use crate::time::{FinalUnitState, StepTiming};
use crate::{Demand, MemoryPorts, Request};

/// An executed step and its numbers of requests.
#[derive(Clone, Copy, Debug)]
pub(super) struct BatchedStep {
    pub(super) demand: Demand,
    pub(super) made: StepTiming,
    pub(super) requests: u32,
    pub(super) look_ups: u32,
}

/// Steps of one stage, in order.
#[derive(Clone, Debug, Default)]
pub(super) struct StageSteps {
    pub(super) steps: Vec<BatchedStep>,
    /// Their requests in order: for each step requests, then look-ups.
    pub(super) asked: Vec<Request>,
    /// The fault of the last step, if it has one.
    pub(super) fault: Option<String>,
}

impl StageSteps {
    /// Appends a step with its requests and its fault.
    #[inline(always)]
    pub(super) fn push(&mut self, demand: Demand, made: StepTiming, traffic: &mut MemoryPorts) {
        let (requests, look_ups) = (traffic.requests(), traffic.look_ups());
        self.steps.push(BatchedStep { demand, made, requests: requests.len() as u32, look_ups: look_ups.len() as u32 });
        if !traffic.is_empty() {
            self.asked.extend_from_slice(requests);
            self.asked.extend_from_slice(look_ups);
            traffic.clear();
        }
        if traffic.fault.is_some() {
            self.fault = traffic.fault.take();
        }
    }

    /// Takes the steps since the last call. A fault stays known.
    pub(super) fn take(&mut self) -> Self {
        let room = (Vec::with_capacity(self.steps.len()), Vec::with_capacity(self.asked.len()));
        let steps = std::mem::replace(&mut self.steps, room.0);
        let asked = std::mem::replace(&mut self.asked, room.1);
        Self { steps, asked, fault: self.fault.clone() }
    }

    /// Returns true if the stage cannot continue.
    #[inline(always)]
    pub(super) fn is_fault(&self) -> bool {
        self.fault.is_some()
    }
}

/// Steps of every stage, as [`make_steps`](super::make_steps) executed them, in the order of the wiring, for
/// [`time_steps`](super::time_steps).
#[derive(Clone, Debug)]
pub struct StepBatch {
    pub(super) stages: Vec<StageSteps>,
    /// State of each unit after these steps.
    pub(super) unit_states: Vec<FinalUnitState>,
    /// True if the run was stopped before its end.
    pub(super) stopped: bool,
}

impl StepBatch {
    /// Number of steps of all stages.
    pub fn steps(&self) -> usize {
        self.stages.iter().map(|stage| stage.steps.len()).sum()
    }
}
