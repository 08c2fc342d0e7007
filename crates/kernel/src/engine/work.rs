//! Work: what the steps of a stage do, one after the other, without time.

use crate::connections::Clients;
use crate::place::Place;
use crate::time::{Known, Made, Rest};
use crate::wiring::{Inputs, Outputs, Visitor};
use crate::{Connections, Demand, Stage, Traffic, Unit};

/// The steps of one stage, in order.
pub(crate) trait Work: Known {
    /// What the next step takes.
    fn demand(&self) -> Demand;
    /// Whether the next step can be made here, once time lets it start.
    fn has_step(&self) -> bool;
    /// Makes it: what it did, and in `traffic` what it asked of memories.
    fn step(&mut self, demand: Demand, traffic: &mut Traffic) -> Made;
}

/// Steps that a unit makes now.
pub(super) struct Live<'a, U, I, O, C> {
    unit: &'a mut U,
    connections: &'a mut Connections<I, O, C>,
}

impl<'a, U, I, O, C> Live<'a, U, I, O, C> {
    pub(super) fn new(stage: &'a mut Stage<U>, connections: &'a mut Connections<I, O, C>) -> Self {
        Self { unit: &mut stage.unit, connections }
    }
}

impl<U, I: Inputs, O: Outputs, C: Clients> Known for Live<'_, U, I, O, C> {
    const INPUTS: Option<usize> = I::COUNT;
    const OUTPUTS: Option<usize> = O::COUNT;
    const HAS_MEMORY: bool = C::HAS_MEMORY;
}

impl<U, I, O, C> Work for Live<'_, U, I, O, C>
where
    U: Unit,
    I: Inputs<Item = U::In>,
    O: Outputs<Item = U::Out>,
    C: Clients,
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
        let step = self.unit.step(self.connections.inputs.pop(demand), traffic);
        if step.occupancy == 0 {
            traffic.fault("a step kept its unit for 0 cycles, expected at least 1 (law 3)".into());
        }
        let outputs = self.connections.outputs.push(step.out);
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
