//! Measures the host time of each unit. It runs the units of a machine without simulated time, each for as long as its FIFOs
//! allow, and reads the clock before and after.
//!
//! Thus each unit gets the tokens of a real run, passes its requests to a handle that keeps them, as under an engine, and pays
//! for popping and pushing. Engine, memories and caches are absent. Two clock readings per visit are included, 50 ns for some ten
//! steps.

use basrelief_kernel::{BoundStage, Connections, Demand, Inputs, Machine, MemoryPorts, Outputs, Unit, Visitor};
use std::time::{Duration, Instant};

/// Measured time of a unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UnitTime {
    /// Time in its steps.
    pub time: Duration,
    /// Number of steps.
    pub steps: u64,
}

#[derive(Default)]
struct Stopwatch {
    traffic: MemoryPorts,
    /// Times by stage, in the order of the wiring.
    units: Vec<UnitTime>,
    next: usize,
    stepped: bool,
}

impl Visitor for Stopwatch {
    fn stage<P: BoundStage>(&mut self, mut place: P) {
        let (stage, Connections { inputs, outputs, .. }) = place.open();
        let began = Instant::now();
        let mut steps = 0;
        while let Some(demand) = ready(&stage.unit, inputs, outputs) {
            let step = stage.unit.step(inputs.pop(demand), &mut self.traffic);
            outputs.push(step.out);
            self.traffic.clear();
            steps += 1;
        }
        let time = began.elapsed();
        if self.units.len() == self.next {
            self.units.push(UnitTime::default());
        }
        if steps > 0 {
            let unit = &mut self.units[self.next];
            unit.time += time;
            unit.steps += steps;
            self.stepped = true;
        }
        self.next += 1;
    }
}

/// Returns the inputs of the next step if it can start now.
fn ready<U: Unit, I: Inputs, O: Outputs>(unit: &U, inputs: &I, outputs: &O) -> Option<Demand> {
    let demand = unit.demand();
    let has_inputs = (0..inputs.count()).all(|i| !demand.takes(i) || !inputs.link(i).is_empty());
    let has_room = || (0..outputs.count()).all(|i| outputs.link(i).has_room());
    (demand != Demand::Finished && has_inputs && has_room()).then_some(demand)
}

/// Runs the machine to its end. Returns time and steps of each unit, in the order of the wiring.
pub fn unit_times<M: Machine>(machine: &mut M) -> Vec<UnitTime> {
    let mut watch = Stopwatch { stepped: true, ..Stopwatch::default() };
    while std::mem::take(&mut watch.stepped) {
        watch.next = 0;
        machine.wire(&mut watch);
    }
    watch.units
}
