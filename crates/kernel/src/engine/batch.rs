//! Step batches: steps on their way from the half of a run that executes them to the half that computes their times.

use crate::time::{FinalUnitState, StepTiming};
use crate::{Demand, MemoryPorts};

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
    /// Their requests and look-ups in order, and the fault of the last step, if it has one.
    pub(super) ports: MemoryPorts,
}

impl StageSteps {
    /// Executes a step and appends it. `step` issues its requests to the ports.
    #[inline(always)]
    pub(super) fn make(&mut self, demand: Demand, step: impl FnOnce(&mut MemoryPorts) -> StepTiming) {
        let [requests, look_ups] = self.ports.lengths();
        let made = step(&mut self.ports);
        let after = self.ports.lengths();
        let (requests, look_ups) = ((after[0] - requests) as u32, (after[1] - look_ups) as u32);
        self.steps.push(BatchedStep { demand, made, requests, look_ups });
    }

    /// Takes the steps since the last call. A fault stays known.
    pub(super) fn take(&mut self) -> Self {
        let steps = Vec::with_capacity(self.steps.len());
        let ports = self.ports.emptied();
        Self { steps: std::mem::replace(&mut self.steps, steps), ports: std::mem::replace(&mut self.ports, ports) }
    }

    /// Returns true if the stage cannot continue.
    #[inline(always)]
    pub(super) fn is_fault(&self) -> bool {
        self.ports.fault.is_some()
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
