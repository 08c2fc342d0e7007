//! The end of a run: outcome, totals and reports.

use super::{FifoTiming, MachineTiming, StageClock, charge};
use crate::netlist::{FifoSpec, StageInfo};
use crate::outcome::{BlockedUnit, Deadlock, FifoLevel, Outcome, WaitsFor, circle};
use crate::port::Port;
use crate::report::{CacheReport, FifoReport, MemoryReport, PeriodicCounts, PortReport, RunReport, UnitReport};
use crate::{Cycle, Demand, MemorySystem, Probe, StallCause};

/// The reason that an engine stopped.
pub(crate) enum StopReason {
    /// No step can ever start.
    Quiet,
    /// The limit of cycles.
    Limit(u64),
    /// The caller asked to stop.
    Stopped,
    /// A unit cannot continue.
    Fault(String),
}

/// The state of a unit at the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FinalUnitState {
    /// Demand of its next step.
    pub(crate) demand: Demand,
    /// True if it holds no token back.
    pub(crate) empty: bool,
}

impl MachineTiming {
    /// Ends a run and returns its report. The probe receives the waits after the last step of each stage. `unit_states`: final state of
    /// each unit.
    pub(crate) fn finalize<P: Probe>(&mut self, unit_states: &[FinalUnitState], halt: StopReason, probe: &mut P) -> RunReport {
        let quiet_total = self.known_total();
        let (complete, total) = match halt {
            StopReason::Quiet => (self.is_done(unit_states), quiet_total.max(1)),
            StopReason::Limit(max) => (false, max),
            StopReason::Stopped | StopReason::Fault(_) => (false, quiet_total),
        };
        self.memories.finish_periodic(Cycle(total));
        let mut stuck = Vec::new();
        let mut waits = Vec::new();
        let units = (0..self.stages.len())
            .map(|stage| {
                let (unit, held_by) = self.unit_report(stage, unit_states[stage].demand, complete, Cycle(total), probe);
                waits.push(held_by.as_ref().and_then(|(_, on)| *on));
                stuck.extend(held_by.map(|(waits_for, _)| BlockedUnit { unit: unit.name.clone(), waits_for }));
                unit
            })
            .collect();
        let name = |stage: usize| self.shape.stages[stage].names.name.clone();
        let outcome = match halt {
            StopReason::Quiet if complete => Outcome::Complete,
            StopReason::Quiet => {
                Outcome::Deadlock(Deadlock { total, stuck, circle: circle(&waits).into_iter().map(name).collect() })
            }
            StopReason::Limit(_) => Outcome::Limit,
            StopReason::Stopped => Outcome::Stopped,
            StopReason::Fault(text) => Outcome::Fault(text),
        };
        let ends: Vec<Cycle> = self.stages.iter().flat_map(|clock| clock.marks.iter().copied()).collect();
        RunReport {
            outcome,
            total,
            marks: cycles_between(&ends, total),
            units,
            fifos: self.fifos.iter().zip(&self.shape.fifos).map(|(slots, fifo)| fifo_report(slots, fifo, total)).collect(),
            memories: memory_reports(&self.memories, total),
            caches: cache_reports(&self.memories),
        }
    }

    /// Cycles that the run takes at least: up to the last that is known to do anything, and to its last mark.
    pub(crate) fn known_total(&self) -> u64 {
        self.last_cycle().map_or(0, |last| last.0 + 1).max(self.memories.data_end().0).max(self.last_mark().0)
    }

    /// The last mark so far; 0 without one.
    pub(crate) fn last_mark(&self) -> Cycle {
        self.stages.iter().flat_map(|clock| &clock.marks).max().copied().unwrap_or_default()
    }

    /// The last cycle in which a unit was busy or a token became visible.
    pub(crate) fn last_cycle(&self) -> Option<Cycle> {
        let busy = self.stages.iter().filter(|clock| clock.steps > 0).map(|clock| Cycle(clock.free.0 - 1));
        busy.chain(self.fifos.iter().filter_map(FifoTiming::last_visible)).max()
    }

    /// Returns true if nothing is left: no token in a FIFO or in a unit, and no step that needs no input.
    fn is_done(&self, unit_states: &[FinalUnitState]) -> bool {
        self.fifos.iter().all(FifoTiming::is_empty) && unit_states.iter().all(|rest| rest.empty && rest.demand != Demand::Nothing)
    }

    /// Returns the report of a unit, and the resource that blocks it for ever with the stage that could provide it.
    fn unit_report<P: Probe>(
        &self,
        stage: usize,
        demand: Demand,
        complete: bool,
        total: Cycle,
        probe: &mut P,
    ) -> (UnitReport, Option<HeldBy>) {
        let clock = &self.stages[stage];
        let StageClock { free, steps, busy, .. } = clock;
        let mut account = self.accounts[stage].clone();
        account.busy = busy - free.since(total);
        let mut held_by = None;
        if demand == Demand::Finished || (complete && *steps > 0) {
            clock.block.split(*free, total, &mut |wait| charge(&mut account, probe, stage, wait));
            account.done += total.since(clock.released());
        } else {
            self.split_wait(stage, demand, *free..total, |wait| charge(&mut account, probe, stage, wait));
            // A unit that was busy until the end waits for it, too.
            self.split_wait(stage, demand, *free..Cycle::UNKNOWN, |wait| held_by = Some(wait.cause));
        }
        let StageInfo { names, .. } = &self.shape.stages[stage];
        let (name, inputs, outputs) = (names.name.clone(), names.inputs.clone(), names.outputs.clone());
        let unit = UnitReport { name, steps: *steps, account, inputs, outputs, clients: names.clients.clone() };
        (unit, held_by.map(|cause| self.waits_for(stage, cause)))
    }

    fn waits_for(&self, stage: usize, cause: StallCause) -> HeldBy {
        let StageInfo { names, inputs, outputs, .. } = &self.shape.stages[stage];
        let fill = |fifo: usize| {
            let FifoSpec { name, depth, .. } = &self.shape.fifos[fifo];
            FifoLevel { fifo: name.clone(), held: self.fifos[fifo].len(), depth: *depth }
        };
        match cause {
            StallCause::Starved(i) => (WaitsFor::Token(fill(inputs[i])), Some(self.shape.fifos[inputs[i]].producer)),
            StallCause::Blocked(i) => (WaitsFor::Slot(fill(outputs[i])), Some(self.shape.fifos[outputs[i]].consumer)),
            StallCause::Memory(i) => (WaitsFor::Memory { port: names.clients[i].clone() }, None),
        }
    }
}

/// The resource that a blocked unit waits for, and the stage that could provide it.
type HeldBy = (WaitsFor, Option<usize>);

fn fifo_report(slots: &FifoTiming, FifoSpec { name, depth, .. }: &FifoSpec, total: u64) -> FifoReport {
    FifoReport { name: name.clone(), depth: *depth, tokens: slots.tokens(), histogram: slots.finish(total) }
}

fn memory_reports(system: &MemorySystem, total: u64) -> Vec<MemoryReport> {
    let ports_of = |memory: usize| -> Vec<PortReport> {
        let ports = system.clients().iter().map(|c| &c.port).enumerate().filter(|(_, p)| p.memory == memory);
        let periodic = |client| system.memories()[memory].periodic.iter().find(|periodic| periodic.client == client);
        let report = |(client, port): (usize, &Port)| PortReport {
            client: port.name.clone(),
            counts: port.counts,
            periodic: periodic(client).map(|periodic| PeriodicCounts { late: port.late, flips: periodic.flips }),
        };
        ports.map(report).collect()
    };
    let report = |(m, memory): (usize, &crate::memory::Memory)| MemoryReport {
        name: memory.name.clone(),
        ports: ports_of(m),
        channels: memory.channel_counts(total),
        bus: memory.bus.clone(),
    };
    system.memories().iter().enumerate().map(report).collect()
}

fn cache_reports(system: &MemorySystem) -> Vec<CacheReport> {
    let caches = system.clients().iter().filter_map(|client| client.cache.as_ref());
    caches.map(|cache| CacheReport { name: cache.name.clone(), counts: cache.counts }).collect()
}

/// Cycles between the marks that lie within the run.
fn cycles_between(ends: &[Cycle], total: u64) -> Vec<u64> {
    let mut before = Cycle::ZERO;
    ends.iter().filter(|end| end.0 <= total).map(|&end| end.since(std::mem::replace(&mut before, end))).collect()
}
