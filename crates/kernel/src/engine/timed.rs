//! `timed`: every stage runs ahead as far as its inputs, outputs and credits are known; when none can go on, the
//! memories answer what nothing still to come can precede. Cost is O(tokens x stages), whatever the cycles.

use super::{Land, Limits, fault_of};
use crate::report::Halt;
use crate::stage::{Clock, charge, next_start, promise, split_wait};
use crate::wiring::{Clients, Inputs, Machine, Outputs, Visitor};
use crate::{Cycle, Probe, Stage, Traffic, Unit};

/// One walk over all stages.
struct RunAhead<'p, P> {
    probe: &'p mut P,
    traffic: Traffic,
    end: Cycle,
    stage: usize,
    moved: bool,
    limited: bool,
    fault: Option<String>,
    /// Whether stages promise how far they have come.
    promises: bool,
}

impl<P: Probe> Visitor for RunAhead<'_, P> {
    #[inline]
    fn stage<U: Unit, I: Inputs<Item = U::In>, O: Outputs<Item = U::Out>, const M: bool>(
        &mut self,
        stage: &mut Stage<U>,
        mut inputs: I,
        mut outputs: O,
        mut clients: Clients<'_, M>,
    ) {
        let number = self.stage;
        self.stage += 1;
        self.moved |= stage.clock.land_known(&mut outputs, &mut clients);
        while let Some(next) = next_start(&stage.unit, &stage.clock, &inputs, &outputs, &clients) {
            if next.at >= self.end {
                self.limited |= next.at.is_known();
                break;
            }
            let free = stage.clock.free;
            if next.at > free {
                let (Clock { needs, account, .. }, probe) = (&mut stage.clock, &mut *self.probe);
                let wires = (&inputs, &outputs, &clients);
                split_wait(needs, next.demand, wires, (free, next.at), |wait| charge(account, probe, number, wait));
            }
            let wires = (&mut inputs, &mut outputs, &mut clients);
            stage.clock.fire(&mut stage.unit, next.demand, next.at, wires, &mut self.traffic);
            self.moved = true;
            if P::is_on() {
                self.probe.worked(number, next.at, stage.clock.free);
            }
            if self.traffic.fault.is_some() {
                self.fault = fault_of(&mut self.traffic, stage.name(), Some(next.at));
                self.end = Cycle::ZERO;
                return;
            }
        }
        if self.promises {
            promise(stage.unit.demand(), stage.clock.free, (&mut inputs, &mut outputs, &mut clients));
        }
    }
}

pub(super) fn run<M: Machine, P: Probe>(machine: &mut M, probe: &mut P, limits: Limits<'_, M>) -> Halt {
    let end = Cycle(limits.max_cycles);
    let promises = machine.memories().has_shared();
    let (traffic, fault) = (Traffic::default(), None);
    let mut walk = RunAhead { probe, traffic, end, stage: 0, moved: false, limited: false, fault, promises };
    for round in 1_u64.. {
        (walk.stage, walk.moved, walk.limited) = (0, false, false);
        machine.wire(&mut walk);
        if let Some(fault) = walk.fault {
            return Halt::Fault(fault);
        }
        let served = machine.memories().serve_promised();
        if !walk.moved && !served && !machine.memories().serve_safe() {
            break;
        }
        if round.is_multiple_of(16) && !(limits.progress)(machine) {
            return Halt::Stopped;
        }
    }
    machine.wire(&mut Land);
    if walk.limited { Halt::Limit(limits.max_cycles) } else { Halt::Quiet }
}
