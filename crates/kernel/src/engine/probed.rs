//! The timed engine under a probe.

use super::arity::advance;
use super::context::{ActiveRecording, RunLimits};
use super::step_source::UnitSteps;
use super::timed::{RunAhead, run_rounds};
use crate::Probe;
use crate::bound_stage::BoundStage;
use crate::machine::{Machine, Visitor};
use crate::time::{MachineTiming, StopReason};

/// One round over all stages under a probe. Steps stand behind pointers: a stage that is compiled as a whole takes four times as
/// long to build, and a run under a probe spends most of its time in the probe.
struct ProbedRound<'w, 'a, SomeProbe>(&'w mut RunAhead<'a, SomeProbe>);

impl<SomeProbe: Probe> Visitor for ProbedRound<'_, '_, SomeProbe> {
    fn stage<P: BoundStage>(&mut self, mut place: P) {
        let (stage, connections) = place.open();
        let number = self.0.round.stage;
        self.0.round.stage += 1;
        let mut steps = UnitSteps::new(stage, connections);
        advance(self.0, number, &mut steps.behind_pointer());
    }
}

/// Runs a machine under a probe.
pub(super) fn run<M: Machine>(
    machine: &mut M,
    time: &mut MachineTiming,
    mut probe: &mut dyn Probe,
    limits: RunLimits<'_, M>,
    recording: Option<ActiveRecording<'_>>,
) -> StopReason {
    let recording = recording.map(ActiveRecording::shortened);
    let walk = RunAhead::new(time, &mut probe, limits.max_cycles, recording);
    run_rounds(machine, walk, limits, |machine, walk| machine.wire(&mut ProbedRound(walk)))
}
