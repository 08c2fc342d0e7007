//! Wrapper of the unit under test. The kernel checks the unit's memory requests, as in any machine.

use basrelief_kernel::{Demand, MemoryPorts, Step, Unit, UnitInfo};
use std::rc::Rc;

/// Hook that runs after each step. An error is a fault.
pub(super) type AfterStep<U> = Rc<dyn Fn(&mut U) -> Result<(), String>>;

/// Forwards all calls to the unit, and calls a hook after each step.
#[derive(Clone)]
pub(super) struct ObservedUnit<U> {
    pub(super) unit: U,
    pub(super) after_step: Option<AfterStep<U>>,
}

impl<U: Unit> Unit for ObservedUnit<U> {
    const INFO: UnitInfo = U::INFO;
    type In = U::In;
    type Out = U::Out;

    fn demand(&self) -> Demand {
        self.unit.demand()
    }

    fn step(&mut self, input: U::In, traffic: &mut MemoryPorts) -> Step<U::Out> {
        let step = self.unit.step(input, traffic);
        let Step { latency, after_data, .. } = step;
        if u64::from(after_data) > latency {
            traffic.fault(format!("a step works {after_data} cycles after its data, expected at most its latency, {latency}"));
        }
        if let Some(Err(text)) = self.after_step.clone().map(|hook| hook(&mut self.unit)) {
            traffic.fault(text);
        }
        step
    }

    fn largest_step(&self, client: usize) -> u32 {
        self.unit.largest_step(client)
    }

    fn is_empty(&self) -> bool {
        self.unit.is_empty()
    }
}
