//! Batches of steps, on their way from the half of a run that makes steps to the half that computes their times.

use crate::time::{FinalUnitState, StepTiming};
use crate::{Demand, MemoryPorts, Request};

/// A step as it was made, and how much it asked.
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
    /// What they asked, one after the other: requests, then look-ups.
    pub(super) asked: Vec<Request>,
    /// Why the last of them is a fault, if it is.
    pub(super) fault: Option<String>,
}

impl StageSteps {
    /// Takes a step in, with what it asked; its fault goes with it.
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

    /// What was taken in since the last call. Whether there was a fault stays known.
    pub(super) fn take(&mut self) -> Self {
        let room = (Vec::with_capacity(self.steps.len()), Vec::with_capacity(self.asked.len()));
        let steps = std::mem::replace(&mut self.steps, room.0);
        let asked = std::mem::replace(&mut self.asked, room.1);
        Self { steps, asked, fault: self.fault.clone() }
    }

    /// Whether its stage cannot go on.
    #[inline(always)]
    pub(super) fn is_fault(&self) -> bool {
        self.fault.is_some()
    }
}

/// Some steps of every stage, as they were [made](make_steps), in the order of the wiring; for who [tells](time_steps) their times.
#[derive(Clone, Debug)]
pub struct StepBatch {
    pub(super) stages: Vec<StageSteps>,
    /// What each stage's next step takes.
    pub(super) unit_states: Vec<FinalUnitState>,
    /// Whether there is more to be done, and nobody does it.
    pub(super) stopped: bool,
}

impl StepBatch {
    /// How many steps it holds, of all stages.
    pub fn steps(&self) -> usize {
        self.stages.iter().map(|stage| stage.steps.len()).sum()
    }
}
