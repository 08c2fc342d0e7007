//! Runs of a scene or a trace on the texture mapping system.

use crate::common;
use crate::common::machine_runs;
pub use crate::common::machine_runs::{functional, machine, run};
pub use crate::common::{Ran, replay, scene_front};
use basrelief_kernel::stats::FigureValue;
use basrelief_machines::UnitStats;
use basrelief_machines::texel::TexelMachineConfig;
use basrelief_signals::{Control, Scene};
use std::sync::Arc;

/// Loads the default configuration with these settings.
pub fn config(settings: &[(&str, &str)]) -> TexelMachineConfig {
    common::config(settings)
}

/// Loads a demo at a small size.
pub fn small_demo(name: &str) -> Arc<Scene> {
    common::small_demo(name, 1)
}

/// Runs the timed engine, and asserts that the run finishes.
pub fn timed(controls: &[Control], settings: &[(&str, &str)]) -> Ran {
    machine_runs::timed::<TexelMachineConfig>(controls, settings)
}

/// Returns a real-valued figure.
pub fn figure(facts: &UnitStats, name: &str) -> f64 {
    match facts.get(name) {
        Some(FigureValue::Real(real)) => *real,
        found => panic!("device figure `{name}`: {found:?}"),
    }
}
