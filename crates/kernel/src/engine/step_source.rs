//! Sources of steps: units, or recorded steps.

use crate::bound_stage::BoundStage;
use crate::connections::Clients;
use crate::machine::Visitor;
use crate::recording::RecordingWriter;
use crate::step_requests::StepRequestsView;
use crate::time::{FinalUnitState, InputMask, PathTracer, StageArity, StageVisit, StepTiming};
use crate::wires::{Inputs, Outputs, Wires};
use crate::{Connections, Cycle, Demand, MAX_CLIENTS, MemoryPorts, OutputWires, Probe, Stage, Step, StepWires, Unit, UnitWires};

/// The steps of one stage, in order.
pub(crate) trait StepSource {
    /// Declaration of a unit about its next step; `()` without a unit.
    type Declared: Copy;
    /// Returns the inputs of the next step, as its unit declares them and as a mask.
    fn next(&self) -> (Self::Declared, InputMask);
    /// Returns true if the next step is available, once its start time is known.
    fn has_step(&self) -> bool;
    /// Executes the step. Its requests go to `traffic` if they are computed only now.
    fn step(&mut self, declared: Self::Declared, traffic: &mut MemoryPorts) -> StepTiming;
    /// Returns true if the step just made has no memory request.
    #[inline(always)]
    fn is_silent(&self, traffic: &MemoryPorts) -> bool
    where
        Self: Sized,
    {
        traffic.is_empty()
    }
    /// Returns the memory requests of the step just made; `None`, with a fault in `traffic`, if they are not allowed.
    #[inline(always)]
    fn requests<'a>(&'a mut self, traffic: &'a mut MemoryPorts, visit: &mut StageVisit<'_>) -> Option<StepRequestsView<'a>>
    where
        Self: Sized,
    {
        visit.settle(traffic)
    }
    /// Traces a step for the critical path, if one is wanted.
    #[inline(always)]
    fn trace<K: StageArity>(
        path: &mut Option<PathTracer>,
        visit: &StageVisit<'_>,
        start: Cycle,
        takes: InputMask,
        is_marked: bool,
    ) where
        Self: Sized,
    {
        _ = (path, visit, start, takes, is_marked);
    }
    /// Moves on to the next step.
    #[inline(always)]
    fn go_on(&mut self, traffic: &mut MemoryPorts)
    where
        Self: Sized,
    {
        if !traffic.is_empty() {
            traffic.clear();
        }
    }
    /// Reports labels and wires of the step just made to a probe that reads them.
    fn report_step(
        &self,
        number: usize,
        declared: Self::Declared,
        made: &StepTiming,
        traffic: &MemoryPorts,
        probe: &mut dyn Probe,
    ) {
        _ = (number, declared, made, traffic, probe);
    }
    /// Appends the step to a recording, unless it comes from one.
    fn write(
        &self,
        writer: &mut RecordingWriter,
        number: usize,
        declared: Self::Declared,
        made: &StepTiming,
        traffic: &MemoryPorts,
    ) {
        _ = (writer, number, declared, made, traffic);
    }
}

/// Steps that a unit executes now.
pub(super) struct UnitSteps<'a, U, I, O, C> {
    unit: &'a mut U,
    connections: &'a mut Connections<I, O, C>,
}

impl<'a, U, I, O, C> UnitSteps<'a, U, I, O, C> {
    pub(super) fn new(stage: &'a mut Stage<U>, connections: &'a mut Connections<I, O, C>) -> Self {
        Self { unit: &mut stage.unit, connections }
    }
}

impl<U, I, O, C> UnitSteps<'_, U, I, O, C>
where
    U: Unit,
    I: Inputs<Item = U::In>,
    O: Outputs<Item = U::Out>,
    C: Clients,
{
    /// Returns the steps behind a pointer. (Inlined, the steps of a unit would be compiled once for each engine that uses them.)
    #[inline(never)]
    pub(super) fn behind_pointer(&mut self) -> &mut AnySteps<'_> {
        self
    }
}

impl<U, I: Inputs, O: Outputs, C: Clients> StageArity for UnitSteps<'_, U, I, O, C> {
    const INPUTS: Option<usize> = I::COUNT;
    const OUTPUTS: Option<usize> = O::COUNT;
    const HAS_MEMORY: bool = C::HAS_MEMORY;
}

impl<U, I, O, C> StepSource for UnitSteps<'_, U, I, O, C>
where
    U: Unit,
    I: Inputs<Item = U::In>,
    O: Outputs<Item = U::Out>,
    C: Clients,
{
    type Declared = Demand;

    #[inline(always)]
    fn next(&self) -> (Demand, InputMask) {
        let demand = self.unit.demand();
        (demand, InputMask::of(demand, self.connections.inputs.count()))
    }

    #[inline(always)]
    fn has_step(&self) -> bool {
        true
    }

    #[inline(always)]
    fn step(&mut self, demand: Demand, traffic: &mut MemoryPorts) -> StepTiming {
        let step = self.unit.step(self.connections.inputs.pop(demand), traffic);
        let Step { occupancy, latency, after_data, blocking, marked, .. } = step;
        let outputs = self.connections.outputs.push(step.out);
        if occupancy == 0 {
            traffic.fault("a step kept its unit for 0 cycles, expected at least 1 (law 3)".into());
        }
        StepTiming { occupancy, latency, after_data, outputs, marked, blocking }
    }

    fn report_step(&self, number: usize, demand: Demand, made: &StepTiming, traffic: &MemoryPorts, probe: &mut dyn Probe) {
        if probe.reads_labels() {
            let Connections { inputs, outputs, .. } = &self.connections;
            let given = (0..outputs.count()).filter(|i| made.outputs >> i & 1 == 1).map(|i| (i, outputs.last_label(i)));
            let given: Vec<_> = given.collect();
            probe.on_step(number, [demand.of(inputs.count()), traffic.clients()], &given);
        }
        if probe.reads_wires() {
            let Connections { inputs, outputs, .. } = &self.connections;
            let given = (0..outputs.count()).filter(|i| made.outputs >> i & 1 == 1).map(|i| (i, outputs.last_bits(i)));
            let (taken, given) = (demand.of(inputs.count()), given.collect::<Vec<_>>());
            let (requests, look_ups) = (traffic.requests(), traffic.look_ups());
            probe.on_wires(number, &StepWires { taken, given: &given, requests, look_ups });
        }
    }

    #[inline(always)]
    fn write(&self, writer: &mut RecordingWriter, number: usize, demand: Demand, made: &StepTiming, traffic: &MemoryPorts) {
        writer.step(number, demand, made, traffic.requests(), traffic);
    }
}

/// Steps behind a pointer, so that an engine is compiled once and not for each unit.
type AnySteps<'a> = dyn StepSource<Declared = Demand> + 'a;

impl StepSource for &mut AnySteps<'_> {
    type Declared = Demand;

    fn next(&self) -> (Demand, InputMask) {
        (**self).next()
    }

    fn has_step(&self) -> bool {
        (**self).has_step()
    }

    fn step(&mut self, demand: Demand, traffic: &mut MemoryPorts) -> StepTiming {
        (**self).step(demand, traffic)
    }

    fn report_step(&self, number: usize, demand: Demand, made: &StepTiming, traffic: &MemoryPorts, probe: &mut dyn Probe) {
        (**self).report_step(number, demand, made, traffic, probe);
    }

    fn write(&self, writer: &mut RecordingWriter, number: usize, demand: Demand, made: &StepTiming, traffic: &MemoryPorts) {
        (**self).write(writer, number, demand, made, traffic);
    }
}

/// Reports every unit to a probe that reads wires.
pub(super) struct WireReport<'a> {
    pub(super) probe: &'a mut dyn Probe,
    pub(super) stage: usize,
}

impl Visitor for WireReport<'_> {
    fn stage<P: BoundStage>(&mut self, mut place: P) {
        let (stage, connections) = place.open();
        let outputs = &connections.outputs;
        let output = |i| OutputWires { fields: outputs.token_fields(i), latency: outputs.link(i).latency() };
        let outputs = (0..outputs.count()).map(output).collect();
        let credits = (0..MAX_CLIENTS).map(|client| stage.unit.largest_step(client)).collect();
        self.probe.on_unit(self.stage, &UnitWires { tables: stage.unit.twin_tables(), outputs, credits });
        self.stage += 1;
    }
}

/// Collects the state of every unit.
#[derive(Default)]
pub(super) struct UnitStates(pub(super) Vec<FinalUnitState>);

impl Visitor for UnitStates {
    fn stage<P: BoundStage>(&mut self, mut place: P) {
        let (stage, _) = place.open();
        self.0.push(FinalUnitState { demand: stage.unit.demand(), empty: stage.unit.is_empty() });
    }
}
