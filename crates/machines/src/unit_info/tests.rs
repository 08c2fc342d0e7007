//! What the tests of all machines share: their wiring, held against drawing and units.

use super::UnitInfo;
use crate::diagram::connections::Connections;
use basrelief_kernel::{Engine, Machine, MemoryReport, StageTopology, run, topology};
use std::collections::BTreeSet;
use std::path::Path;

/// How a machine is wired under one configuration.
pub(crate) struct Wiring {
    stages: Vec<StageTopology>,
    memories: Vec<MemoryReport>,
}

impl Wiring {
    pub(crate) fn of(machine: &mut impl Machine) -> Self {
        Self { stages: topology(machine), memories: run(machine, Engine::Timed).memories }
    }

    /// Producer, FIFO, consumer.
    fn fifos(&self) -> impl Iterator<Item = [String; 3]> + '_ {
        let from = self.stages.iter().flat_map(|stage| stage.outputs.iter().map(move |fifo| (&stage.name, fifo)));
        from.flat_map(|(producer, fifo)| {
            let to = self.stages.iter().filter(move |stage| stage.inputs.contains(fifo));
            to.map(move |consumer| [producer.clone(), fifo.clone(), consumer.name.clone()])
        })
    }

    /// Unit, client, memory.
    fn clients(&self) -> impl Iterator<Item = [String; 3]> + '_ {
        let from = self.stages.iter().flat_map(|stage| stage.clients.iter().map(move |client| (&stage.name, client)));
        from.flat_map(|(unit, client)| {
            let to = self.memories.iter().filter(move |memory| memory.ports.iter().any(|port| port.client == *client));
            to.map(move |memory| [unit.clone(), client.clone(), memory.name.clone()])
        })
    }
}

/// `units` are exactly the stages that are wired. The drawing shows each of them, always with the same numeral, and exactly
/// the FIFOs and clients that are wired, each from where and to where it is wired.
pub(crate) fn drawing_is_the_wiring(drawing: &str, units: &[UnitInfo], all: &[Wiring]) {
    let wired: BTreeSet<&str> = all.iter().flat_map(|w| &w.stages).map(|s| s.name.as_str()).collect();
    assert_eq!(units.iter().map(|u| u.name.as_str()).collect::<BTreeSet<_>>(), wired);
    let wiring = Connections {
        units: units.iter().map(|u| (u.name.clone(), u.numeral.clone())).collect(),
        fifos: all.iter().flat_map(Wiring::fifos).collect(),
        clients: all.iter().flat_map(Wiring::clients).collect(),
    };
    assert_eq!(Connections::read(drawing).unwrap(), wiring);
}

/// Every unit has a role, and stands in the file that is named.
pub(crate) fn every_unit_says_what_it_does_and_where(units: &[UnitInfo]) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for unit in units {
        assert!(!unit.role.is_empty(), "{} has no role!", unit.name);
        let code = std::fs::read_to_string(root.join(&unit.code)).unwrap_or_else(|e| panic!("{}: {e}", unit.code));
        assert!(code.contains(&format!("role!(\"{}\")", unit.role)), "{} is not in {}", unit.name, unit.code);
    }
}
