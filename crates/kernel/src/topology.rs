//! The topology of a machine, without running it.

use crate::bound_stage::BoundStage;
use crate::connections::{Clients, Connections};
use crate::diagram::StageTopology;
use crate::machine::{Machine, Visitor};
use crate::wires::{Inputs, Outputs};
use crate::{Stage, Unit};

impl StageTopology {
    /// Describes a stage with its connections.
    pub(crate) fn of<U, I: Inputs, O: Outputs, C: Clients>(stage: &Stage<U>, connections: &Connections<I, O, C>) -> Self
    where
        U: Unit,
    {
        let Connections { inputs, outputs, clients } = connections;
        let client = |&c: &usize| clients.memories().map_or("", |s| s.client_name(c)).to_owned();
        Self {
            name: stage.name().into(),
            role: U::INFO,
            inputs: (0..inputs.count()).map(|i| inputs.link(i).name().to_owned()).collect(),
            outputs: (0..outputs.count()).map(|i| outputs.link(i).name().to_owned()).collect(),
            clients: clients.ids().iter().map(client).collect(),
        }
    }
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
