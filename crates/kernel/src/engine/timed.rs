//! `timed`: every stage runs ahead as far as its inputs, outputs and credits are known; when none can go on, the
//! memories answer what nothing still to come can precede. Cost is O(tokens x stages), whatever the cycles.

use super::{Land, Limits, fault_of};
use crate::place::Place;
use crate::report::Halt;
use crate::stage::{Clock, charge};
use crate::wiring::{Machine, Visitor};
use crate::{Cycle, Probe, Traffic, Unit};

/// One walk over all stages.
struct RunAhead<'p, SomeProbe> {
    probe: &'p mut SomeProbe,
    traffic: Traffic,
    end: Cycle,
    stage: usize,
    moved: bool,
    limited: bool,
    fault: Option<String>,
    /// Whether stages promise how far they have come.
    promises: bool,
}

impl<SomeProbe: Probe> Visitor for RunAhead<'_, SomeProbe> {
    #[inline]
    fn stage<P: Place>(&mut self, mut place: P) {
        let (stage, connections) = place.open();
        let number = self.stage;
        self.stage += 1;
        self.moved |= stage.clock.land_known(connections);
        while let Some(next) = connections.next_start(&stage.unit, &stage.clock) {
            if next.at >= self.end {
                self.limited |= next.at.is_known();
                break;
            }
            let free = stage.clock.free;
            if next.at > free {
                let (Clock { needs, account, .. }, probe) = (&mut stage.clock, &mut *self.probe);
                connections.split_wait(needs, next.demand, (free, next.at), |wait| charge(account, probe, number, wait));
            }
            stage.fire(&next, connections, &mut self.traffic);
            self.moved = true;
            if SomeProbe::is_on() {
                self.probe.worked(number, next.at, stage.clock.free);
            }
            if self.traffic.fault.is_some() {
                self.fault = fault_of(&mut self.traffic, stage.name(), Some(next.at));
                self.end = Cycle::ZERO;
                return;
            }
        }
        if self.promises {
            connections.promise(stage.unit.demand(), stage.clock.free);
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
