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
