//! Work: what the steps of a stage do, one after the other, without time.

use crate::asked::Asks;
use crate::connections::Clients;
use crate::machine::Visitor;
use crate::place::Place;
use crate::tape::Writer;
use crate::time::{Known, Made, Rest, Takes, Visit};
use crate::wires::{Inputs, Outputs};
use crate::{Connections, Demand, Probe, Stage, Traffic, Unit};

/// The steps of one stage, in order.
pub(crate) trait Work {
    /// What a unit declares of its next step: nothing, where there is no unit.
    type Declared: Copy;
    /// What the next step takes, as its unit declares it and as time looks at it.
    fn next(&self) -> (Self::Declared, Takes);
    /// Whether the next step can be made here, once time lets it start.
    fn has_step(&self) -> bool;
    /// Makes it: what it did, and in `traffic` what it asked of memories, where it is made only now.
    fn step(&mut self, declared: Self::Declared, traffic: &mut Traffic) -> Made;
    /// Whether the step that was just made asked nothing of memories.
    #[inline(always)]
    fn is_silent(&self, traffic: &Traffic) -> bool {
        traffic.is_empty()
    }
    /// What the step that was just made, in this visit, asked of memories; none, and a fault in `traffic`, where it must not.
    #[inline(always)]
    fn asks<'a>(&'a mut self, traffic: &'a mut Traffic, visit: &mut Visit<'_>) -> Option<Asks<'a>> {
        visit.settle(traffic)
    }
    /// Goes on behind that step.
    #[inline(always)]
    fn go_on(&mut self, traffic: &mut Traffic) {
        if !traffic.is_empty() {
            traffic.clear();
        }
    }
    /// Tells a probe that asks what the step was about that has just been made.
    fn tell<P: Probe>(&self, number: usize, (declared, made): (Self::Declared, &Made), traffic: &Traffic, probe: &mut P) {
        _ = (number, declared, made, traffic, probe);
    }
    /// Writes it on a tape, unless it comes from one.
    fn write(&self, tape: &mut Writer, number: usize, (declared, made): (Self::Declared, &Made), traffic: &Traffic) {
        _ = (tape, number, declared, made, traffic);
    }
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
    type Declared = Demand;

    #[inline(always)]
    fn next(&self) -> (Demand, Takes) {
        let demand = self.unit.demand();
        (demand, Takes::of(demand, self.connections.inputs.count()))
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

    #[inline(always)]
    fn tell<P: Probe>(&self, number: usize, (demand, made): (Demand, &Made), traffic: &Traffic, probe: &mut P) {
        if P::is_on() && probe.reads_labels() {
            let Connections { inputs, outputs, .. } = &self.connections;
            let given = (0..outputs.count()).filter(|i| made.outputs >> i & 1 == 1).map(|i| (i, outputs.last_label(i)));
            let given: Vec<_> = given.collect();
            probe.stepped(number, [demand.of(inputs.count()), traffic.clients()], &given);
        }
    }

    #[inline(always)]
    fn write(&self, tape: &mut Writer, number: usize, (demand, made): (Demand, &Made), traffic: &Traffic) {
        tape.step(number, demand, made, traffic);
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
