//! The shape of a machine: what its wiring says, as plain data. With it time can be told without the machine.

use crate::connections::Clients;
use crate::place::Place;
use crate::topology::StageTopology;
use crate::wiring::{MAX_CLIENTS, Machine, Visitor, Wires};
use crate::{MemorySystem, Unit};

/// Everything that time depends on beside what the units do: stages, FIFOs, and memories on which nothing has been asked yet.
#[derive(Clone, Debug)]
pub struct Shape {
    pub(crate) stages: Vec<StageShape>,
    pub(crate) fifos: Vec<FifoShape>,
    pub(crate) memories: MemorySystem,
}

/// A stage: its names, and the numbers of what it is joined to.
#[derive(Clone, Debug)]
pub(crate) struct StageShape {
    pub(crate) names: StageTopology,
    pub(crate) inputs: Vec<usize>,
    pub(crate) outputs: Vec<usize>,
    pub(crate) clients: Vec<usize>,
    /// Credits that the largest step needs, by client.
    pub(crate) credits: [u32; MAX_CLIENTS],
}

/// A FIFO.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct FifoShape {
    pub(crate) name: String,
    pub(crate) depth: usize,
    pub(crate) latency: u64,
    /// Numbers of the stages at its ends.
    pub(crate) producer: usize,
    pub(crate) consumer: usize,
}

impl Shape {
    /// Of a machine whose wiring has been checked.
    pub(crate) fn of(machine: &mut impl Machine) -> Self {
        let mut number = Number(0);
        machine.wire(&mut number);
        let mut walk = Walk::default();
        machine.wire(&mut walk);
        Self { stages: walk.stages, fifos: walk.fifos, memories: machine.memories().clone() }
    }
}

/// Numbers the FIFOs, in the order of the wiring, by producer.
struct Number(usize);
impl Visitor for Number {
    fn stage<P: Place>(&mut self, mut place: P) {
        let (_, connections) = place.open();
        for i in 0..connections.outputs.count() {
            connections.outputs.link_mut(i).set_number(self.0);
            self.0 += 1;
        }
    }
}

#[derive(Default)]
struct Walk {
    stages: Vec<StageShape>,
    fifos: Vec<FifoShape>,
}

impl Visitor for Walk {
    fn stage<P: Place>(&mut self, mut place: P) {
        let (stage, connections) = place.open();
        let numbers = |wires: &dyn Wires| (0..wires.count()).map(|i| wires.link(i).number()).collect();
        let clients = connections.clients.ids().to_vec();
        let credits = std::array::from_fn(|i| if i < clients.len() { stage.unit.largest_step(i) } else { 0 });
        let (inputs, outputs) = (numbers(&connections.inputs), numbers(&connections.outputs));
        let names = StageTopology::of(stage, connections);
        self.stages.push(StageShape { names, inputs, outputs, clients, credits });
        for link in (0..connections.outputs.count()).map(|i| connections.outputs.link(i)) {
            let (producer, consumer) = (link.producer().unwrap_or_default(), link.consumer().unwrap_or_default());
            let (depth, latency) = (link.depth(), link.latency());
            self.fifos.push(FifoShape { name: link.name().into(), depth, latency, producer, consumer });
        }
    }
}
