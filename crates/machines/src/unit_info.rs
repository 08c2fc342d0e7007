//! The boxes of a block diagram, in words: gathered from the wiring, what its units say of themselves, and the drawing.

use basrelief_kernel::{Machine, topology};

/// A box of the block diagram.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitInfo {
    /// Name in the report.
    pub name: String,
    /// The patent's reference numeral; empty where the patent has no such box.
    pub numeral: String,
    /// What it does.
    pub role: &'static str,
    /// Where its code is: a file, from the root of the repository on.
    pub code: String,
}

/// The boxes of a machine's block diagram, in the order of its wiring: first those behind a scene, then what a recorded display
/// list has in their place. The numerals are those of the drawing.
pub fn units(diagram: &str, of_scene: &mut impl Machine, of_trace: &mut impl Machine) -> Vec<UnitInfo> {
    let drawn = drawn_units(diagram);
    let mut all: Vec<UnitInfo> = Vec::new();
    for stage in topology(of_scene).into_iter().chain(topology(of_trace)) {
        if all.iter().any(|unit| unit.name == stage.name) {
            continue;
        }
        let numeral = drawn.iter().find(|(name, _)| *name == stage.name).map_or("", |(_, numeral)| numeral);
        let numeral = numeral.to_owned();
        all.push(UnitInfo { name: stage.name, numeral, role: stage.role.does, code: file_of(stage.role.module) });
    }
    all
}

/// Units as a drawing shows them, `[name (numeral)]`: name and numeral, which is empty where there is none. A unit that is drawn
/// more than once is there as often.
pub fn drawn_units(diagram: &str) -> Vec<(&str, &str)> {
    let boxes = diagram.split('[').skip(1).filter_map(|rest| Some(rest.split_once(']')?.0.trim()));
    boxes.map(|text| text.strip_suffix(')').and_then(|text| text.split_once(" (")).unwrap_or((text, ""))).collect()
}

/// The file of a unit crate's module: every unit stands in a file of its own, none in a `mod.rs`.
fn file_of(module: &str) -> String {
    let (package, path) = module.split_once("::").unwrap_or((module, "lib"));
    let folder = package.trim_start_matches("basrelief_").replace('_', "-");
    format!("crates/units/{folder}/src/{}.rs", path.replace("::", "/"))
}

/// The tests of a machine's boxes and drawing: `checks_the_drawing!(Machine, [config, ...])`. Its stages are those that are wired
/// under any of these configurations, the first of them the default, whichever way in.
#[cfg(test)]
macro_rules! checks_the_drawing {
    ($machine:ident, [$($config:expr),+]) => {
        use $crate::unit_info::tests::{Wiring, drawing_is_the_wiring, every_unit_says_what_it_does_and_where};
        use $crate::{SceneFront, TraceFront};

        type Replayed = std::iter::Empty<Result<(basrelief_signals::Control, Option<u64>), String>>;
        type Wired<Drawn> = ($machine<SceneFront<Drawn>>, $machine<TraceFront<Replayed>>);

        /// The machine behind either way in, under each configuration.
        fn all() -> Vec<Wired<std::iter::Empty<basrelief_signals::Draw>>> {
            let wired = |config| {
                let scene = SceneFront::new(std::iter::empty(), &config);
                let trace = TraceFront::new(std::iter::empty(), &config);
                ($machine::new(scene, &config).unwrap(), $machine::new(trace, &config).unwrap())
            };
            vec![$(wired($config)),+]
        }

        fn units() -> Vec<crate::UnitInfo> {
            let (mut scene, mut trace) = all().remove(0);
            crate::units(DIAGRAM, &mut scene, &mut trace)
        }

        #[test]
        fn the_drawing_is_the_wiring_edge_by_edge() {
            let wirings = all().into_iter().flat_map(|(mut a, mut b)| [Wiring::of(&mut a), Wiring::of(&mut b)]);
            drawing_is_the_wiring(DIAGRAM, &units(), &wirings.collect::<Vec<_>>());
        }

        #[test]
        fn every_unit_says_what_it_does_and_where_its_code_is() {
            every_unit_says_what_it_does_and_where(&units());
        }
    };
}
#[cfg(test)]
pub(crate) use checks_the_drawing;

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

    /// `units` are exactly the stages that are wired. The drawing shows each of them, always with the same numeral, and exactly
    /// the FIFOs and clients that are wired, each from where and to where it is wired.
    pub(crate) fn drawing_is_the_wiring(drawing: &str, units: &[UnitInfo], all: &[Wiring]) {
        let wired: BTreeSet<&str> = all.iter().flat_map(|w| &w.stages).map(|s| s.name.as_str()).collect();
        assert_eq!(units.iter().map(|u| u.name.as_str()).collect::<BTreeSet<_>>(), wired);
        let wiring = Drawing {
            units: units.iter().map(|u| (u.name.clone(), u.numeral.clone())).collect(),
            fifos: all.iter().flat_map(Wiring::fifos).collect(),
            clients: all.iter().flat_map(Wiring::clients).collect(),
        };
        assert_eq!(Drawing::read(drawing).unwrap(), wiring);
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

    #[test]
    fn units_are_read_from_a_drawing_with_their_numerals() {
        assert_eq!(super::drawn_units(" [a (1)] --x--> [ b  ]  (2) [ c (3b) ]"), [("a", "1"), ("b", ""), ("c", "3b")]);
    }
}
