//! The functional model: the same steps, without time; memories answer at once (law 6). The steps can be passed to another thread
//! that computes their times.

use super::batch::{StageSteps, StepBatch};
use super::context::{fault_of, unit_states};
use super::step_source::{StepSource, UnitSteps};
use crate::bound_stage::BoundStage;
use crate::machine::{Machine, Visitor};
use crate::wires::{Inputs, Outputs};
use crate::{Connections, Demand, MemoryPorts, Unit};

struct FunctionalWalk {
    /// Ports without memories, if no times are computed.
    traffic: MemoryPorts,
    stage: usize,
    /// Number of steps, and of those passed on.
    steps: usize,
    handed_on: usize,
    /// Fault of a stage that cannot continue.
    fault: Option<String>,
    /// Steps of the stages, if their times are computed.
    made: Option<Vec<StageSteps>>,
    /// Steps per batch. A stage between long FIFOs could make any number of steps before the next stage runs, so it makes at most
    /// a part of a batch at once.
    batch_steps: usize,
}

/// Parts of a batch that a stage makes at once.
const PARTS: usize = 4;

impl FunctionalWalk {
    fn new(made: Option<Vec<StageSteps>>, batch_steps: usize) -> Self {
        Self { traffic: MemoryPorts::discarding(), stage: 0, steps: 0, handed_on: 0, fault: None, made, batch_steps }
    }

    /// Returns the steps since the last batch.
    fn next_batch(&mut self, machine: &mut impl Machine, stopped: bool) -> StepBatch {
        self.handed_on = self.steps;
        let stages = self.made.iter_mut().flatten().map(StageSteps::take).collect();
        StepBatch { stages, unit_states: unit_states(machine), stopped }
    }
}

/// Returns the demand of the next step of a stage, if the step can be made now.
#[inline(always)]
fn next<U: Unit, I: Inputs, O: Outputs, C>(
    unit: &U,
    Connections { inputs, outputs, .. }: &Connections<I, O, C>,
) -> Option<Demand> {
    let demand = unit.demand();
    let ready = demand != Demand::Finished
        && (0..inputs.count()).all(|i| !demand.takes(i) || !inputs.link(i).is_empty())
        && (0..outputs.count()).all(|i| outputs.link(i).has_room());
    ready.then_some(demand)
}

impl Visitor for FunctionalWalk {
    #[inline]
    fn stage<P: BoundStage>(&mut self, mut place: P) {
        let (stage, connections) = place.open();
        let Self { traffic, stage: number, steps, fault, made: all, batch_steps, .. } = self;
        let mut own = all.as_mut().map(|all| &mut all[*number]);
        *number += 1;
        // Timing must reach the start of a step with a fault, so all other stages continue as far as they can.
        if own.as_ref().map_or(fault.is_some(), |own| own.is_fault()) {
            return;
        }
        let (mut count, most) = (0, batch_steps.div_ceil(PARTS));
        while count < most
            && let Some(demand) = next(&stage.unit, connections)
        {
            count += 1;
            let mut unit = UnitSteps::new(&mut *stage, &mut *connections);
            if let Some(own) = &mut own {
                own.make(demand, |ports| unit.step(demand, ports));
                if own.is_fault() {
                    break;
                }
                continue;
            }
            unit.step(demand, traffic);
            if traffic.fault.is_some() {
                *fault = fault_of(traffic, stage.name(), None);
                break;
            }
        }
        *steps += count;
    }
}

pub(super) fn run<M: Machine>(machine: &mut M, progress: &mut dyn FnMut(&mut M) -> bool) -> Result<(), String> {
    let mut walk = FunctionalWalk::new(None, usize::MAX);
    let stopped = walk_on(machine, &mut walk, progress, &mut |_, _| ());
    match walk.fault {
        Some(fault) => Err(fault),
        None if stopped => Err("stopped".into()),
        None => Ok(()),
    }
}

/// As `run`, and passes the steps on, `steps` at a time. `nothing`: empty lists for all stages.
pub(super) fn run_to<M: Machine>(
    machine: &mut M,
    progress: &mut dyn FnMut(&mut M) -> bool,
    steps: usize,
    nothing: Vec<StageSteps>,
    hand_on: &mut dyn FnMut(StepBatch),
) {
    let mut walk = FunctionalWalk::new(Some(nothing), steps);
    let stopped = walk_on(machine, &mut walk, progress, &mut |walk, machine| {
        if walk.steps - walk.handed_on >= walk.batch_steps {
            hand_on(walk.next_batch(machine, false));
        }
    });
    hand_on(walk.next_batch(machine, stopped));
}

/// Executes all steps and calls `look` after each round. Returns true if the run was stopped.
fn walk_on<M: Machine>(
    machine: &mut M,
    walk: &mut FunctionalWalk,
    progress: &mut dyn FnMut(&mut M) -> bool,
    look: &mut dyn FnMut(&mut FunctionalWalk, &mut M),
) -> bool {
    for round in 1_u64.. {
        let before = walk.steps;
        walk.stage = 0;
        machine.wire(walk);
        if walk.steps == before || walk.fault.is_some() {
            break;
        }
        look(walk, machine);
        if (round.is_multiple_of(16) || machine.has_news()) && !progress(machine) {
            return true;
        }
    }
    false
}
