//! Which machines and which demo scenes there are.

use basrelief_scene::DEMOS;
use basrelief_sim::{MACHINES, MachineInfo};
use pyo3::pyfunction;

/// Names of the machines, each with what it is, in a sentence.
#[pyfunction]
pub fn machines() -> Vec<(&'static str, &'static str)> {
    MACHINES.iter().map(|machine| (machine.name, machine.about)).collect()
}

/// Names of the demo scenes, each with the machine that it is made for, and what it shows, in a sentence.
#[pyfunction]
pub fn demos() -> Vec<(&'static str, &'static str, &'static str)> {
    DEMOS.iter().map(|demo| (demo.name, MachineInfo::of_demo(demo.name).name, demo.about)).collect()
}
