//! Runs of a scene on both engines and the functional model.

use crate::common::{self, scene_front};
pub use crate::common::{Ran, small_demo};
use basrelief_frame_buffer::FinishedFrame;
use basrelief_kernel::{Engine, Probe};
use basrelief_machines::UnitStats;
use basrelief_machines::bump::{BumpProcessor, BumpProcessorConfig};
use basrelief_signals::Scene;
use std::sync::Arc;

/// Loads the default configuration with these settings.
pub fn config(settings: &[(&str, &str)]) -> BumpProcessorConfig {
    common::config(settings)
}

pub fn machine(scene: &Arc<Scene>, config: &BumpProcessorConfig) -> BumpProcessor {
    BumpProcessor::new(scene_front(scene, config), config).unwrap_or_else(|e| panic!("{e}"))
}

pub fn run_probed(scene: &Arc<Scene>, config: &BumpProcessorConfig, engine: Engine, probe: &mut dyn Probe) -> Ran {
    common::run_probed(machine(scene, config), engine, Some(probe))
}

/// Runs the timed engine, and asserts that the run finishes.
pub fn timed(scene: &Arc<Scene>, settings: &[(&str, &str)]) -> Ran {
    common::timed(machine(scene, &config(settings)), settings)
}

/// Returns pictures and figures of the functional model.
pub fn functional(scene: &Arc<Scene>, config: &BumpProcessorConfig) -> (Vec<FinishedFrame>, UnitStats) {
    common::functional(machine(scene, config))
}
