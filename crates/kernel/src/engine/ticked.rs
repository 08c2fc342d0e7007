//! `ticked`: every unit in every cycle. It asks for the cause of a wait one cycle at a time, and counts the slots held at the end
//! of each cycle; `timed` does both by intervals.
//!
//! What it shares with `timed`: when a step can start (`Connections::next_start`), the causes of a wait
//! (`Connections::split_wait`), the making of a step (`Stage::fire`), the steps in flight, the links and the memories. It is the
//! oracle of the *order* in which things are done, and of what is added up over intervals; an error in what both share it cannot
//! see. For that there is an executable reading of the laws that shares no code with this crate. Its results stand in
//! `tests/vectors/laws.jsonl`, one plan and result per line, and `tests/vectors.rs` holds both engines against them. To
//! repeat it with another reading: give it the `plan` of each line, and compare; `examples/plan.rs` runs one plan, or a
//! folder of such vectors, from the command line.

use super::{Land, Limits, fault_of};
use crate::connections::{Clients, Connections};
use crate::place::Place;
use crate::report::Halt;
use crate::stage::{Clock, Start, Wait, charge};
use crate::wiring::{Inputs, Machine, Outputs, Visitor, Wires};
use crate::{Cycle, Probe, Stage, Traffic, Unit};

/// One cycle of all stages.
struct Tick<'p, SomeProbe> {
    probe: &'p mut SomeProbe,
    traffic: Traffic,
    now: Cycle,
    stage: usize,
    fired: bool,
    /// The last cycle in which something already decided still happens.
    horizon: Cycle,
    fault: Option<String>,
}

impl<SomeProbe: Probe> Tick<'_, SomeProbe> {
    fn work<U, I, O, C>(&mut self, stage: &mut Stage<U>, start: &Start, connections: &mut Connections<I, O, C>)
    where
        U: Unit,
        I: Inputs<Item = U::In>,
        O: Outputs<Item = U::Out>,
        C: Clients,
    {
        for wait in std::mem::take(&mut stage.clock.waits) {
            charge(&mut stage.clock.account, self.probe, self.stage, wait);
        }
        stage.fire(start, connections, &mut self.traffic);
        self.fired = true;
        if SomeProbe::is_on() {
            self.probe.worked(self.stage, self.now, stage.clock.free);
        }
        if self.traffic.fault.is_some() && self.fault.is_none() {
            self.fault = fault_of(&mut self.traffic, stage.name(), Some(self.now));
        }
    }
}

impl<SomeProbe: Probe> Visitor for Tick<'_, SomeProbe> {
    fn stage<P: Place>(&mut self, mut place: P) {
        let (stage, connections) = place.open();
        let now = self.now;
        if stage.clock.free <= now
            && let Some(next) = connections.next_start(&stage.unit, &stage.clock)
        {
            if next.at <= now {
                self.work(stage, &Start { at: now, ..next }, connections);
            } else {
                let Clock { waits, needs, .. } = &mut stage.clock;
                connections.split_wait(needs, next.demand, (now, now + 1), |wait| join(waits, wait));
            }
        }
        self.horizon = self.horizon.max(stage.clock.free);
        let outputs = &connections.outputs;
        for i in 0..outputs.count() {
            self.horizon = self.horizon.max(outputs.link(i).last_visible().unwrap_or_default());
        }
        self.stage += 1;
    }
}

fn join(waits: &mut Vec<Wait>, (cause, from, to): Wait) {
    match waits.last_mut() {
        Some(last) if last.0 == cause && last.2 == from => last.2 = to,
        _ => waits.push((cause, from, to)),
    }
}

/// Counts slots held at the end of a cycle.
struct CountHeld(Cycle);
impl Visitor for CountHeld {
    fn stage<P: Place>(&mut self, mut place: P) {
        let (_, Connections { outputs, .. }) = place.open();
        for i in 0..outputs.count() {
            outputs.link_mut(i).count_held(self.0);
        }
    }
}

/// Notes what is known of the answers that slots wait for: `timed` asks when all are known, and this engine in every cycle.
struct NoteAwaits;
impl Visitor for NoteAwaits {
    fn stage<P: Place>(&mut self, mut place: P) {
        let (stage, connections) = place.open();
        stage.clock.note_awaits(connections);
    }
}

/// Whether any stage has a known next start.
struct AnyStart(bool);
impl Visitor for AnyStart {
    fn stage<P: Place>(&mut self, mut place: P) {
        let (stage, connections) = place.open();
        let next = connections.next_start(&stage.unit, &stage.clock);
        self.0 |= next.is_some_and(|next| next.at.is_known());
    }
}

pub(super) fn run<M: Machine, P: Probe>(machine: &mut M, probe: &mut P, limits: Limits<'_, M>) -> Halt {
    machine.memories().share_all();
    let mut tick =
        Tick { probe, traffic: Traffic::default(), now: Cycle::ZERO, stage: 0, fired: false, horizon: Cycle::ZERO, fault: None };
    loop {
        if tick.now.0 >= limits.max_cycles {
            // No request is still to come.
            machine.memories().serve_before(Cycle::UNKNOWN);
            machine.wire(&mut Land);
            let mut any = AnyStart(false);
            machine.wire(&mut any);
            if any.0 {
                return Halt::Limit(limits.max_cycles);
            }
            // No step will ever start: what has started runs out, and is counted.
        }
        (tick.stage, tick.fired, tick.horizon) = (0, false, Cycle::ZERO);
        machine.wire(&mut tick);
        if let Some(fault) = tick.fault {
            return Halt::Fault(fault);
        }
        machine.memories().serve_before(tick.now + 1);
        machine.wire(&mut Land);
        machine.wire(&mut NoteAwaits);
        machine.wire(&mut CountHeld(tick.now));
        let horizon = tick.horizon.max(machine.memories().last_answer());
        if !tick.fired && horizon <= tick.now && machine.memories().is_idle() {
            return Halt::Quiet;
        }
        tick.now = tick.now + 1;
        if tick.now.0.is_multiple_of(4096) && !(limits.progress)(machine) {
            return Halt::Stopped;
        }
    }
}
