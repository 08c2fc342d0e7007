//! The netlist of a machine: its wiring as plain data. With it the timing of a run can be computed without the machine.

use crate::bound_stage::BoundStage;
use crate::capacity::MAX_CLIENTS;
use crate::check::{WiringError, check_wiring};
use crate::connections::Clients;
use crate::diagram::{Diagram, FifoTopology, StageTopology};
use crate::machine::{Machine, Visitor};
use crate::memory::Memory;
use crate::periodic::PeriodicControl;
use crate::wires::Wires;
use crate::{FifoInfo, MemorySystem, Unit};

/// Everything on which timing depends, apart from the work of the units: stages, FIFOs, and memories in their initial state.
#[derive(Clone, Debug)]
pub struct Netlist {
    pub(crate) stages: Vec<StageInfo>,
    pub(crate) fifos: Vec<FifoSpec>,
    pub(crate) memories: MemorySystem,
}

/// A stage: its names and the numbers of its connections.
#[derive(Clone, Debug)]
pub(crate) struct StageInfo {
    pub(crate) names: StageTopology,
    pub(crate) inputs: Vec<usize>,
    pub(crate) outputs: Vec<usize>,
    pub(crate) clients: Vec<usize>,
    /// Credits that the largest step needs, by client.
    pub(crate) credits: [u32; MAX_CLIENTS],
    /// True if its unit is fully pipelined for a relaxation.
    pub(crate) ideal: bool,
}

/// A FIFO.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub(crate) struct FifoSpec {
    pub(crate) name: String,
    pub(crate) depth: usize,
    pub(crate) latency: u64,
    pub(crate) period: u64,
    /// Width of a slot \[bits\].
    bits: u32,
    /// Numbers of its producer and consumer stages.
    pub(crate) producer: usize,
    pub(crate) consumer: usize,
}

impl FifoSpec {
    fn of(link: &FifoInfo) -> Self {
        let (producer, consumer) = (link.producer().unwrap_or_default(), link.consumer().unwrap_or_default());
        let (depth, latency, period, bits) = (link.depth(), link.latency(), link.period(), link.bits());
        Self { name: link.name().into(), depth, latency, period, bits, producer, consumer }
    }
}

impl Netlist {
    /// Returns the netlist of a machine.
    ///
    /// # Errors
    /// If the wiring is invalid.
    pub fn of(machine: &mut impl Machine) -> Result<Self, WiringError> {
        check_wiring(machine)?;
        let mut number = FifoNumbering(0);
        machine.wire(&mut number);
        let mut walk = NetlistWalk::default();
        machine.wire(&mut walk);
        Ok(Self { stages: walk.stages, fifos: walk.fifos, memories: machine.memories().clone() })
    }

    /// Slot width of the FIFO of this name \[bits\]; 0 if there is no such FIFO or its width is unknown.
    pub fn fifo_bits(&self, name: &str) -> u32 {
        self.fifos.iter().find(|fifo| fifo.name == name).map_or(0, |fifo| fifo.bits)
    }

    /// The cache in front of the memory client of this name; `None` if there is none.
    pub fn cache_of(&self, client: &str) -> Option<&str> {
        let client = self.memories.clients().iter().find(|c| c.port.name == client)?;
        Some(&client.cache.as_ref()?.name)
    }

    /// True if a flip of a periodic client has to wait for its time, or holds what the client reads.
    pub fn waits_for_periodic(&self) -> bool {
        let mut controls = self.memories.clients().iter().filter_map(|client| client.control);
        controls.any(|(_, of)| matches!(of, PeriodicControl::Flip(timing) if timing.period > 1 || timing.hold > 0))
    }

    /// Returns the block diagram for probes.
    pub fn diagram(&self) -> Diagram {
        let fifo = |f: &FifoSpec| FifoTopology { name: f.name.clone(), depth: f.depth, ends: [f.producer, f.consumer] };
        let users = |client: usize| (0..self.stages.len()).filter(|&s| self.stages[s].clients.contains(&client)).collect();
        Diagram {
            stages: self.stages.iter().map(|stage| stage.names.clone()).collect(),
            fifos: self.fifos.iter().map(fifo).collect(),
            memories: self.memories.memories().iter().map(Memory::topology).collect(),
            clients: self.memories.clients().iter().zip(0..).map(|(c, number)| c.topology(users(number))).collect(),
        }
    }

    /// Checks that the units of another machine do the same work, as far as a netlist shows: the same stages with the same
    /// connections, largest steps and cache lines. (Other values that a unit derives from its parameters are not in the netlist.)
    ///
    /// # Errors
    /// Describes the first difference.
    pub fn same_work(&self, other: &Self) -> Result<(), String> {
        let wires =
            |shape: &Self| shape.fifos.iter().map(|f| (f.name.clone(), f.bits, f.producer, f.consumer)).collect::<Vec<_>>();
        if wires(self) != wires(other) || self.stages.len() != other.stages.len() {
            return Err("its units are joined in another way, or hand on wider or narrower tokens".into());
        }
        for (ours, theirs) in self.stages.iter().zip(&other.stages) {
            let name = &ours.names.name;
            if ours.names != theirs.names {
                return Err(format!("in place of `{name}` there is `{}`, or it uses other memories", theirs.names.name));
            }
            if ours.credits != theirs.credits {
                return Err(format!("the largest step of `{name}` is another: what it does follows from what was changed"));
            }
        }
        let lines = |shape: &Self| shape.memories.line_bytes().collect::<Vec<_>>();
        if lines(self) == lines(other) { Ok(()) } else { Err("the lines of its caches are others".into()) }
    }
}

/// Numbers the FIFOs, in the order of the wiring by producer.
struct FifoNumbering(usize);
impl Visitor for FifoNumbering {
    fn stage<P: BoundStage>(&mut self, mut place: P) {
        self.number(&mut place.open().1.outputs);
    }
}

impl FifoNumbering {
    fn number(&mut self, outputs: &mut dyn Wires) {
        for i in 0..outputs.count() {
            outputs.link_mut(i).set_number(self.0);
            self.0 += 1;
        }
    }
}

#[derive(Default)]
struct NetlistWalk {
    stages: Vec<StageInfo>,
    fifos: Vec<FifoSpec>,
}

impl Visitor for NetlistWalk {
    fn stage<P: BoundStage>(&mut self, mut place: P) {
        let (stage, connections) = place.open();
        let clients = connections.clients.ids().to_vec();
        let credits = std::array::from_fn(|i| if i < clients.len() { stage.unit.largest_step(i) } else { 0 });
        let (names, ideal) = (StageTopology::of(stage, connections), stage.is_ideal());
        let (inputs, outputs) = (numbers(&connections.inputs), numbers(&connections.outputs));
        self.stages.push(StageInfo { names, inputs, outputs, clients, credits, ideal });
        self.fifos.extend(specs(&connections.outputs));
    }
}

fn numbers(wires: &dyn Wires) -> Vec<usize> {
    (0..wires.count()).map(|i| wires.link(i).number()).collect()
}

fn specs(outputs: &dyn Wires) -> impl Iterator<Item = FifoSpec> {
    (0..outputs.count()).map(|i| FifoSpec::of(outputs.link(i)))
}
