//! What a run came to: accounting, occupancy, traffic.

use crate::connections::{Clients, Connections};
use crate::outcome::{Deadlock, Fill, Outcome, Stuck, WaitsFor, circle};
use crate::place::Place;
use crate::topology::StageTopology;
use crate::wiring::{Inputs, Machine, Outputs, Visitor, Wires};
use crate::{Account, Bus, CacheCounts, Cause, ChannelCounts, Cycle, Demand, Link, PortCounts, Unit};

/// A unit's part of the report. Inputs, outputs and clients stand in the order of the wiring.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitReport {
    /// Name in the block diagram.
    pub name: String,
    /// Steps made.
    pub steps: u64,
    /// Where its cycles went; sums to the total.
    pub account: Account,
    /// Names of its input FIFOs.
    pub inputs: Vec<String>,
    /// Names of its output FIFOs.
    pub outputs: Vec<String>,
    /// Names of its memory clients.
    pub clients: Vec<String>,
}

/// A FIFO's part of the report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FifoReport {
    /// Name.
    pub name: String,
    /// Slots.
    pub depth: usize,
    /// Tokens that went through.
    pub tokens: u64,
    /// `histogram[k]` = cycles with k slots held; sums to the total (law 10).
    pub histogram: Vec<u64>,
}

impl FifoReport {
    /// Most slots ever held.
    pub fn high_water(&self) -> usize {
        self.histogram.iter().rposition(|&n| n > 0).unwrap_or(0)
    }
}

/// A memory's part of the report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MemoryReport {
    /// Name.
    pub name: String,
    /// Its ports, in order of number.
    pub ports: Vec<PortReport>,
    /// Its channels, in order of number.
    pub channels: Vec<ChannelCounts>,
    /// When its buses moved data.
    pub bus: Bus,
}

/// A memory port's part of the report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PortReport {
    /// The client behind it.
    pub client: String,
    /// What it moved.
    pub counts: PortCounts,
}

/// A cache's part of the report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CacheReport {
    /// Name.
    pub name: String,
    /// What its look-ups found.
    pub counts: CacheCounts,
}

/// What a run came to. Equal, byte for byte, whatever the engine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunReport {
    /// How it ended.
    pub outcome: Outcome,
    /// Cycles in all: 1 + the last cycle in which anything moved.
    pub total: u64,
    /// Cycles up to each mark from the one before (law 11); what is left of the total is drain.
    pub marks: Vec<u64>,
    /// In the order of the wiring.
    pub units: Vec<UnitReport>,
    /// In the order of the wiring, by producer.
    pub fifos: Vec<FifoReport>,
    /// In the order in which they were added.
    pub memories: Vec<MemoryReport>,
    /// In the order in which they were added.
    pub caches: Vec<CacheReport>,
}

impl RunReport {
    /// Of a run that could not begin.
    pub(crate) fn of_fault(fault: String) -> Self {
        let (marks, units, fifos, memories, caches) = Default::default();
        Self { outcome: Outcome::Fault(fault), total: 0, marks, units, fifos, memories, caches }
    }
}

/// Looks at every stage at rest: what is left, and the last cycle in which anything moved.
#[derive(Default)]
struct Survey {
    last: Option<Cycle>,
    stuck: bool,
    marks: Vec<Cycle>,
}

impl Visitor for Survey {
    fn stage<P: Place>(&mut self, mut place: P) {
        let (stage, Connections { inputs, outputs, .. }) = place.open();
        if stage.clock.steps > 0 {
            self.last = self.last.max(Some(Cycle(stage.clock.free.0 - 1)));
        }
        for i in 0..outputs.count() {
            self.last = self.last.max(outputs.link(i).last_visible());
        }
        self.stuck |= (0..inputs.count()).any(|i| !inputs.link(i).is_empty());
        self.stuck |= !stage.unit.is_empty() || stage.unit.demand() == Demand::Nothing;
        self.marks.append(&mut stage.clock.marks);
    }
}

/// Writes every stage's and FIFO's part of the report.
struct Conclude {
    complete: bool,
    total: Cycle,
    units: Vec<UnitReport>,
    fifos: Vec<FifoReport>,
    stuck: Vec<Stuck>,
    /// Per stage, the one that it waits for for ever.
    waits: Vec<Option<usize>>,
}

impl Visitor for Conclude {
    fn stage<P: Place>(&mut self, mut place: P) {
        let (stage, connections) = place.open();
        let free = stage.clock.free;
        let demand = stage.unit.demand();
        let mut waits = None;
        let mut account = stage.clock.account.clone();
        account.busy -= free.since(self.total);
        if demand == Demand::Finished || (self.complete && stage.clock.steps > 0) {
            account.done += self.total.since(free);
        } else {
            let needs = &stage.clock.needs;
            connections.split_wait(needs, demand, (free, self.total), |(cause, from, to)| account.charge(cause, to.since(from)));
            // What holds it for ever; a unit that was busy up to the end waits for it, too.
            let mut last = None;
            connections.split_wait(needs, demand, (free, Cycle::UNKNOWN), |(cause, ..)| last = Some(cause));
            if let Some(cause) = last {
                let (waits_for, on) = waits_for(cause, connections);
                self.stuck.push(Stuck { unit: stage.name().into(), waits_for });
                waits = on;
            }
        }
        self.waits.push(waits);
        let StageTopology { name, inputs, outputs: names, clients } = StageTopology::of(stage, connections);
        let wires = &mut connections.outputs;
        self.units.push(UnitReport { name, steps: stage.clock.steps, account, inputs, outputs: names, clients });
        for i in 0..wires.count() {
            let link = wires.link_mut(i);
            let (name, depth, tokens) = (link.name().to_owned(), link.depth(), link.tokens());
            self.fifos.push(FifoReport { name, depth, tokens, histogram: link.finish(self.total.0).to_vec() });
        }
    }
}

/// What a unit waits for that cannot go on, and the stage that could give it.
fn waits_for<I, O, C>(cause: Cause, connections: &Connections<I, O, C>) -> (WaitsFor, Option<usize>)
where
    I: Inputs,
    O: Outputs,
    C: Clients,
{
    let Connections { inputs, outputs, clients } = connections;
    let fill = |link: &Link| Fill { fifo: link.name().into(), held: link.len(), depth: link.depth() };
    match cause {
        Cause::Starved(i) => (WaitsFor::Token(fill(inputs.link(i))), inputs.link(i).producer()),
        Cause::Blocked(i) => (WaitsFor::Slot(fill(outputs.link(i))), outputs.link(i).consumer()),
        Cause::Memory(i) => {
            let port = clients.memories().map_or("", |memories| memories.client_name(clients.ids()[i])).into();
            (WaitsFor::Memory { port }, None)
        }
    }
}

/// Why an engine stopped.
pub(crate) enum Halt {
    /// No step can ever start.
    Quiet,
    /// The limit of cycles.
    Limit(u64),
    /// The caller asked to stop.
    Stopped,
    /// A unit cannot go on.
    Fault(String),
}

/// Ends a run: outcome, total, and everybody's part.
pub(crate) fn conclude<M: Machine>(machine: &mut M, halt: Halt) -> RunReport {
    let mut survey = Survey::default();
    machine.wire(&mut survey);
    let data_end = machine.memories().data_end();
    let quiet_total = survey.last.map_or(0, |c| c.0 + 1).max(data_end.0);
    let (complete, total) = match halt {
        Halt::Quiet => (!survey.stuck, quiet_total.max(1)),
        Halt::Limit(max) => (false, max),
        Halt::Stopped | Halt::Fault(_) => (false, quiet_total),
    };
    let mut parts = Conclude { complete, total: Cycle(total), units: vec![], fifos: vec![], stuck: vec![], waits: vec![] };
    machine.wire(&mut parts);
    let outcome = match halt {
        Halt::Quiet if complete => Outcome::Complete,
        Halt::Quiet => {
            let circle = circle(&parts.waits).into_iter().map(|stage| parts.units[stage].name.clone()).collect();
            Outcome::Deadlock(Deadlock { total, stuck: parts.stuck, circle })
        }
        Halt::Limit(_) => Outcome::Limit,
        Halt::Stopped => Outcome::Stopped,
        Halt::Fault(text) => Outcome::Fault(text),
    };
    let system = machine.memories();
    let ports_of = |memory: usize| -> Vec<PortReport> {
        let ports = system.clients().iter().map(|c| &c.port).filter(|p| p.memory == memory);
        ports.map(|p| PortReport { client: p.name.clone(), counts: p.counts }).collect()
    };
    RunReport {
        outcome,
        total,
        marks: between(&survey.marks, total),
        units: parts.units,
        fifos: parts.fifos,
        memories: (system.memories().iter().enumerate())
            .map(|(m, memory)| MemoryReport {
                name: memory.name.clone(),
                ports: ports_of(m),
                channels: memory.channel_counts(total),
                bus: memory.bus.clone(),
            })
            .collect(),
        caches: (system.clients().iter())
            .filter_map(|c| c.cache.as_ref())
            .map(|c| CacheReport { name: c.name.clone(), counts: c.counts })
            .collect(),
    }
}

/// Cycles between marks, of those that lie within the run.
fn between(ends: &[Cycle], total: u64) -> Vec<u64> {
    let mut before = Cycle::ZERO;
    ends.iter().filter(|end| end.0 <= total).map(|&end| end.since(std::mem::replace(&mut before, end))).collect()
}
