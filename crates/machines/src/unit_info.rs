//! The boxes of a block diagram, in words.

/// A box of the block diagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnitInfo {
    /// Name in the report.
    pub name: &'static str,
    /// The patent's reference numeral; empty where the patent has no such box.
    pub numeral: &'static str,
    /// What it does.
    pub role: &'static str,
    /// Where its code is.
    pub code: &'static str,
}

/// A row of the table.
pub(crate) const fn unit(name: &'static str, numeral: &'static str, role: &'static str, code: &'static str) -> UnitInfo {
    UnitInfo { name, numeral, role, code }
}

/// The tests of a machine's table and drawing: `checks_the_table!(Machine, [config, ...])`. Its stages are those that are wired
/// under any of these configurations, whichever way in.
#[cfg(test)]
macro_rules! checks_the_table {
    ($machine:ident, [$($config:expr),+]) => {
        use $crate::unit_info::tests::{Wiring, code_is_there, drawing_is_the_wiring, map_shows_the_drawing, names_the_stages};
        use $crate::{SceneFront, TraceFront};

        fn all() -> Vec<Wiring> {
            let mut all = Vec::new();
            for config in [$($config),+] {
                let scene = SceneFront::new(std::iter::empty::<basrelief_signals::Draw>(), &config);
                all.push(Wiring::of(&mut $machine::new(scene, &config).unwrap()));
                let trace = std::iter::empty::<Result<(basrelief_signals::Control, Option<u64>), String>>();
                let trace = TraceFront::new(trace, &config);
                all.push(Wiring::of(&mut $machine::new(trace, &config).unwrap()));
            }
            all
        }

        #[test]
        fn the_table_names_exactly_the_stages_that_are_wired() {
            names_the_stages(UNITS, &all());
        }

        #[test]
        fn the_drawing_is_the_wiring_edge_by_edge() {
            drawing_is_the_wiring(DIAGRAM, UNITS, &all());
        }

        #[test]
        fn the_map_shows_the_same_drawing() {
            map_shows_the_drawing(DIAGRAM);
        }

        #[test]
        fn the_code_is_where_the_table_says() {
            code_is_there(UNITS);
        }
    };
}
#[cfg(test)]
pub(crate) use checks_the_table;

#[cfg(test)]
pub(crate) mod tests {
    use super::UnitInfo;
    use crate::drawing::Drawing;
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

    /// The table names exactly the stages that are wired.
    pub(crate) fn names_the_stages(units: &[UnitInfo], all: &[Wiring]) {
        let wired: BTreeSet<&str> = all.iter().flat_map(|w| &w.stages).map(|s| s.name.as_str()).collect();
        let named: BTreeSet<&str> = units.iter().map(|u| u.name).collect();
        assert_eq!(wired, named);
    }

    /// The drawing shows every unit with its numeral, and exactly the FIFOs and clients that are wired, each from where and to
    /// where it is wired.
    pub(crate) fn drawing_is_the_wiring(drawing: &str, units: &[UnitInfo], all: &[Wiring]) {
        let numeral = |u: &UnitInfo| if u.numeral.is_empty() { String::new() } else { format!(" ({})", u.numeral) };
        let wiring = Drawing {
            units: units.iter().map(|u| u.name.to_owned() + &numeral(u)).collect(),
            fifos: all.iter().flat_map(Wiring::fifos).collect(),
            clients: all.iter().flat_map(Wiring::clients).collect(),
        };
        assert_eq!(Drawing::read(drawing).unwrap(), wiring);
    }

    /// docs/architecture.md shows the same drawing.
    pub(crate) fn map_shows_the_drawing(drawing: &str) {
        let map = include_str!("../../../docs/architecture.md");
        assert!(map.contains(&format!("```\n{}\n```", drawing.trim_end())), "docs/architecture.md shows another drawing");
    }

    /// The code is where the table says.
    pub(crate) fn code_is_there(units: &[UnitInfo]) {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        for unit in units {
            assert!(root.join(unit.code).exists(), "{}", unit.code);
        }
    }
}
