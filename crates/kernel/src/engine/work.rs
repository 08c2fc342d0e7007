//! Work: what the steps of a stage do, one after the other, without time.

use crate::time::{Made, Rest};
use crate::wiring::{Inputs, Outputs, Visitor};
use crate::place::Place;
use crate::{Demand, Traffic, Unit};

/// The steps of one stage, in order.
pub(crate) trait Work {
    /// What the next step takes.
    fn demand(&self) -> Demand;
    /// Whether the next step can be made here, once time lets it start.
    fn has_step(&self) -> bool;
    /// Makes it: what it did, and in `traffic` what it asked of memories.
    fn step(&mut self, demand: Demand, traffic: &mut Traffic) -> Made;
}

/// Steps that a unit makes now.
pub(super) struct Live<'a, U, I, O> {
    pub(super) unit: &'a mut U,
    pub(super) inputs: &'a mut I,
    pub(super) outputs: &'a mut O,
}

impl<U, I, O> Work for Live<'_, U, I, O>
where
    U: Unit,
    I: Inputs<Item = U::In>,
    O: Outputs<Item = U::Out>,
{
    #[inline(always)]
    fn demand(&self) -> Demand {
        self.unit.demand()
    }

    #[inline(always)]
    fn has_step(&self) -> bool {
        true
    }

    #[inline(always)]
    fn step(&mut self, demand: Demand, traffic: &mut Traffic) -> Made {
        let step = self.unit.step(self.inputs.pop(demand), traffic);
        if step.occupancy == 0 {
            traffic.fault("a step kept its unit for 0 cycles, expected at least 1 (law 3)".into());
        }
        let outputs = self.outputs.push(step.out);
        Made { occupancy: step.occupancy, latency: step.latency, outputs, marked: step.marked }
    }
}

/// Asks every unit what is left of it.
#[derive(Default)]
pub(super) struct Survey(pub(super) Vec<Rest>);

impl Visitor for Survey {
    fn stage<P: Place>(&mut self, mut place: P) {
        let (stage, _) = place.open();
        self.0.push(Rest { demand: stage.unit.demand(), empty: stage.unit.is_empty() });
    }
}
