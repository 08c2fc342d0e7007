//! Description of the units of a machine, from the wiring, the units and the block diagram.

use crate::diagram::numeral_of;
use basrelief_kernel::{Machine, topology};

/// Unit of the block diagram.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitInfo {
    /// Name in the report.
    pub name: String,
    /// Reference numeral of the patent; empty if the patent has no such unit.
    pub numeral: String,
    /// Function of the unit.
    pub role: &'static str,
    /// Source file, relative to the root of the repository.
    pub code: String,
}

/// Returns the units of a machine in the order of the wiring: first those for a scene, then those that only a trace has. The numerals are
/// those of the block diagram.
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

/// Returns the source file of a unit's module. Every unit has its own file, and none is in a `mod.rs`.
fn file_of(module: &str) -> String {
    let (package, path) = module.split_once("::").unwrap_or((module, "lib"));
    let folder = package.trim_start_matches("basrelief_").replace('_', "-");
    format!("crates/units/{folder}/src/{}.rs", path.replace("::", "/"))
}

/// Tests of a machine's units and block diagram: `diagram_tests!(Machine, [config, ...])`. The stages are those of all configurations, with
/// both front ends. The first configuration is the default.
#[cfg(test)]
macro_rules! diagram_tests {
    ($machine:ident, [$($config:expr),+]) => {
        use $crate::unit_info::tests::{MachineWiring, assert_diagram_matches_wiring, assert_units_have_roles_and_files};
        use $crate::{SceneFront, TraceFront};

        type Replayed = std::iter::Empty<Result<(basrelief_signals::Control, Option<u64>), String>>;
        type Wired<Drawn> = ($machine<SceneFront<Drawn>>, $machine<TraceFront<Replayed>>);

        /// The machine with both front ends, under each configuration.
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
        fn diagram_matches_wiring() {
            let wirings = all().into_iter().flat_map(|(mut a, mut b)| [MachineWiring::of(&mut a), MachineWiring::of(&mut b)]);
            assert_diagram_matches_wiring(DIAGRAM, &units(), &wirings.collect::<Vec<_>>());
        }

        #[test]
        fn every_unit_has_a_role_and_a_source_file() {
            assert_units_have_roles_and_files(&units());
        }
    };
}
#[cfg(test)]
pub(crate) use diagram_tests;

#[cfg(test)]
pub(crate) mod tests;
