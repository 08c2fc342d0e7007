//! A machine whose wiring follows a plan.

use super::check::{PlanError, check};
use super::format::{Plan, PlanCache, PlanFlips, PlanPeriodic, PlanPort, PlannedUnit};
use super::unit::{PlanUnit, Token};
use basrelief_kernel::{CacheConfig, Fifo, FlipTiming, Machine, MemorySystem, PeriodicReads, Stage, Visitor};
use std::collections::BTreeMap;

/// A stage and the numbers of its FIFOs and clients.
#[derive(Clone, Debug)]
struct PlannedStage {
    stage: Stage<PlanUnit>,
    inputs: Vec<usize>,
    outputs: Vec<usize>,
    clients: Vec<usize>,
}

/// A machine built from a plan.
#[derive(Clone, Debug)]
pub struct PlanMachine {
    fifos: Vec<Fifo<Token>>,
    stages: Vec<PlannedStage>,
    memories: MemorySystem,
}

impl PlanMachine {
    /// Builds the machine.
    ///
    /// # Errors
    /// If the plan is invalid. The error contains the place, the field and the expectation.
    pub fn new(plan: &Plan) -> Result<Self, PlanError> {
        check(plan)?;
        let fifos: Vec<_> = plan.fifos.iter().map(|f| Fifo::new(&f.name, f.depth, f.latency).with_period(f.period)).collect();
        let numbers: BTreeMap<&str, usize> = plan.fifos.iter().enumerate().map(|(i, f)| (f.name.as_str(), i)).collect();
        let find = |names: &[String]| names.iter().filter_map(|n| numbers.get(n.as_str()).copied()).collect();
        let mut memories = MemorySystem::default();
        let ports = add_memories(plan, &mut memories);
        let mut place = |unit: &PlannedUnit| {
            let (clients, of_request) = clients_of(plan, unit, &ports);
            clients.iter().for_each(|&client| memories.set_issue_rate(client, unit.issue));
            let mut stage = Stage::new(&unit.name, PlanUnit::new(unit, of_request));
            if unit.ideal {
                stage.make_ideal();
            }
            PlannedStage { stage, inputs: find(&unit.inputs), outputs: find(&unit.outputs), clients }
        };
        let stages = plan.units.iter().map(&mut place).collect();
        Ok(Self { fifos, stages, memories })
    }

    /// Returns each sink's name and its consumed tokens in order.
    pub fn sink_tokens(&self) -> impl Iterator<Item = (&str, &[Token])> {
        let sinks = self.stages.iter().filter(|p| p.outputs.is_empty());
        sinks.map(|p| (p.stage.name(), p.stage.unit.consumed_tokens()))
    }
}

/// Adds all memories and ports, and the caches in front of ports. Returns client numbers by port name.
fn add_memories<'p>(plan: &'p Plan, memories: &mut MemorySystem) -> BTreeMap<&'p str, usize> {
    let mut ports = BTreeMap::new();
    for m in &plan.memories {
        let memory = memories.add_memory(&m.name, &m.config);
        let mut periodic = BTreeMap::new();
        for p in &m.periodic {
            let &PlanPeriodic { period, bytes, stride, span, .. } = p;
            let reads = PeriodicReads { period, bytes, base: 0, stride, span };
            periodic.insert(p.name.as_str(), memories.add_periodic_client(&p.name, memory, reads));
        }
        for p in &m.ports {
            let client = match (plan.caches.iter().find(|c| c.port == p.name), &p.flips) {
                (None, None) => memories.add_client(&p.name, memory, p.outstanding),
                (None, Some(PlanFlips { of, wait: true, .. })) => {
                    memories.add_wait_client(&p.name, periodic[of.as_str()], p.outstanding)
                }
                (None, Some(PlanFlips { of, period, hold, .. })) => {
                    let timing = FlipTiming { period: *period, hold: *hold };
                    memories.add_flip_client(&p.name, periodic[of.as_str()], timing, p.outstanding)
                }
                (Some(cache), _) => add_cached(memories, memory, p, cache),
            };
            ports.insert(p.name.as_str(), client);
        }
    }
    ports
}

/// Adds a port with a cache in front of it. Returns its client number.
fn add_cached(memories: &mut MemorySystem, memory: usize, port: &PlanPort, c: &PlanCache) -> usize {
    let cache = CacheConfig {
        line_bytes: c.line_bytes,
        sets: c.sets,
        ways: c.ways,
        hit_latency: c.hit_latency,
        lookups_per_cycle: c.lookups_per_cycle,
        always_hits: c.always_hits,
    };
    let client = memories.add_cached_client(&port.name, memory, port.outstanding, &c.name, &cache);
    if !c.at_once {
        memories.spread_look_ups(client);
    }
    client
}

/// Returns a unit's clients in order of first mention, and the index of the client of each request.
fn clients_of(plan: &Plan, unit: &PlannedUnit, ports: &BTreeMap<&str, usize>) -> (Vec<usize>, Vec<u32>) {
    let find = |port: &str| ports.get(port).copied();
    let mut clients = Vec::new();
    let mut of_request = Vec::new();
    for client in unit.kind.requests().iter().filter_map(|r| find(&r.port)) {
        let at = clients.iter().position(|&c| c == client).unwrap_or(clients.len());
        if at == clients.len() {
            clients.push(client);
        }
        of_request.push(at as u32);
    }
    clients.extend(unit.kind.cache().and_then(|cache| plan.caches.iter().find(|c| c.name == cache)).and_then(|c| find(&c.port)));
    (clients, of_request)
}

impl Machine for PlanMachine {
    fn wire<V: Visitor>(&mut self, v: &mut V) {
        for placed in &mut self.stages {
            let mut fifos: Vec<Option<&mut Fifo<Token>>> = self.fifos.iter_mut().map(Some).collect();
            let mut pick =
                |numbers: &[usize]| -> Vec<&mut Fifo<Token>> { numbers.iter().filter_map(|&i| fifos[i].take()).collect() };
            let (inputs, outputs) = (pick(&placed.inputs), pick(&placed.outputs));
            v.stage(placed.stage.between(inputs, outputs).using(&mut self.memories, &placed.clients));
        }
    }

    fn memories(&mut self) -> &mut MemorySystem {
        &mut self.memories
    }
}
