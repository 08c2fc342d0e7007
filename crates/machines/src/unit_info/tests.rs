//! Shared tests of all machines: wiring against block diagram and units.

use super::UnitInfo;
use crate::diagram::connections::DiagramConnections;
use basrelief_kernel::{Engine, Machine, MemoryReport, StageTopology, run, topology};
use std::collections::BTreeSet;
use std::path::Path;

/// Wiring of a machine under one configuration.
pub(crate) struct MachineWiring {
    stages: Vec<StageTopology>,
    memories: Vec<MemoryReport>,
}

impl MachineWiring {
    pub(crate) fn of(machine: &mut impl Machine) -> Self {
        Self { stages: topology(machine), memories: run(machine, Engine::Timed).memories }
    }

    /// Returns producer, FIFO and consumer of each edge.
    fn fifos(&self) -> impl Iterator<Item = [String; 3]> + '_ {
        let from = self.stages.iter().flat_map(|stage| stage.outputs.iter().map(move |fifo| (&stage.name, fifo)));
        from.flat_map(|(producer, fifo)| {
            let to = self.stages.iter().filter(move |stage| stage.inputs.contains(fifo));
            to.map(move |consumer| [producer.clone(), fifo.clone(), consumer.name.clone()])
        })
    }

    /// Returns unit, client and memory of each memory port. A periodic client has no unit.
    fn clients(&self) -> impl Iterator<Item = [String; 3]> + '_ {
        let from = self.stages.iter().flat_map(|stage| stage.clients.iter().map(move |client| (stage.name.as_str(), client)));
        let ports = self.memories.iter().flat_map(|memory| &memory.ports);
        let periodic = ports.filter(|port| port.periodic.is_some()).map(|port| ("", &port.client));
        from.chain(periodic).flat_map(|(unit, client)| {
            let to = self.memories.iter().filter(move |memory| memory.ports.iter().any(|port| port.client == *client));
            to.map(move |memory| [unit.to_owned(), client.clone(), memory.name.clone()])
        })
    }
}

/// Asserts that `units` are exactly the wired stages, and that the diagram shows exactly these units, their FIFOs and their memory clients.
pub(crate) fn assert_diagram_matches_wiring(drawing: &str, units: &[UnitInfo], all: &[MachineWiring]) {
    let wired: BTreeSet<&str> = all.iter().flat_map(|w| &w.stages).map(|s| s.name.as_str()).collect();
    assert_eq!(units.iter().map(|u| u.name.as_str()).collect::<BTreeSet<_>>(), wired);
    let wiring = DiagramConnections {
        units: units.iter().map(|u| (u.name.clone(), u.numeral.clone())).collect(),
        fifos: all.iter().flat_map(MachineWiring::fifos).collect(),
        clients: all.iter().flat_map(MachineWiring::clients).collect(),
    };
    assert_eq!(DiagramConnections::read(drawing).unwrap(), wiring);
}

/// Asserts that every unit has a role, and that its source file contains it.
pub(crate) fn assert_units_have_roles_and_files(units: &[UnitInfo]) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for unit in units {
        assert!(!unit.role.is_empty(), "{} has no role!", unit.name);
        let code = std::fs::read_to_string(root.join(&unit.code)).unwrap_or_else(|e| panic!("{}: {e}", unit.code));
        assert!(code.contains(&format!("unit_info!(\"{}\")", unit.role)), "{} is not in {}", unit.name, unit.code);
    }
}
