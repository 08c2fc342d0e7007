//! Available machines and demo scenes.

use basrelief_scene::DEMOS;
use basrelief_sim::{MACHINES, MachineInfo};
use pyo3::pyfunction;

/// Returns the machines: name and description.
#[pyfunction]
pub fn machines() -> Vec<(&'static str, &'static str)> {
    MACHINES.iter().map(|machine| (machine.name, machine.about)).collect()
}

/// Returns the demo scenes: name, machine and description.
#[pyfunction]
pub fn demos() -> Vec<(&'static str, &'static str, &'static str)> {
    DEMOS.iter().map(|demo| (demo.name, MachineInfo::of_demo(demo.name).name, demo.about)).collect()
}
