//! The boxes of a block diagram, in words: gathered from the wiring, what its units say of themselves, and the drawing.

use crate::diagram::numeral_of;
use basrelief_kernel::{Machine, topology};

/// A box of the block diagram.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitInfo {
    /// Name in the report.
    pub name: String,
    /// The patent's reference numeral; empty where the patent has no such box.
    pub numeral: String,
    /// What it purpose.
    pub role: &'static str,
    /// Where its code is: a file, from the root of the repository on.
    pub code: String,
}

/// The boxes of a machine's block diagram, in the order of its wiring: first those behind a scene, then what a recorded display
/// list has in their place. The numerals are those of the drawing.
pub fn units(diagram: &str, of_scene: &mut impl Machine, of_trace: &mut impl Machine) -> Vec<UnitInfo> {
    let mut all: Vec<UnitInfo> = Vec::new();
    for stage in topology(of_scene).into_iter().chain(topology(of_trace)) {
        if all.iter().any(|unit| unit.name == stage.name) {
            continue;
        }
        let numeral = numeral_of(diagram, &stage.name).to_owned();
        all.push(UnitInfo { name: stage.name, numeral, role: stage.role.purpose, code: file_of(stage.role.module) });
    }
    all
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
pub(crate) mod tests;
