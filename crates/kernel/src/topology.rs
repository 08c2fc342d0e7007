//! The topology of a machine, without running it.

use crate::bound_stage::BoundStage;
use crate::connections::{Clients, Connections};
use crate::diagram::StageTopology;
use crate::machine::{Machine, Visitor};
use crate::wires::Wires;
use crate::{Stage, Unit};

impl StageTopology {
    /// Describes a stage with its connections.
    pub(crate) fn of<U: Unit>(stage: &Stage<U>, connections: &Connections<impl Wires, impl Wires, impl Clients>) -> Self {
        let Connections { inputs, outputs, clients } = connections;
        Self {
            name: stage.name().into(),
            role: U::INFO,
            inputs: fifo_names(inputs),
            outputs: fifo_names(outputs),
            clients: client_names(clients),
        }
    }
}

fn fifo_names(wires: &dyn Wires) -> Vec<String> {
    (0..wires.count()).map(|i| wires.link(i).name().to_owned()).collect()
}

fn client_names(clients: &impl Clients) -> Vec<String> {
    let client = |&c: &usize| clients.memories().map_or("", |s| s.client_name(c)).to_owned();
    clients.ids().iter().map(client).collect()
}

/// Returns all stages of a machine, in the order of its wiring.
pub fn topology(machine: &mut impl Machine) -> Vec<StageTopology> {
    struct TopologyWalk(Vec<StageTopology>);
    impl Visitor for TopologyWalk {
        fn stage<P: BoundStage>(&mut self, mut place: P) {
            let (stage, connections) = place.open();
            self.0.push(StageTopology::of(stage, connections));
        }
    }
    let mut walk = TopologyWalk(Vec::new());
    machine.wire(&mut walk);
    walk.0
}
