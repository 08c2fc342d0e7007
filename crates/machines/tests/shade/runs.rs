//! Running a scene or a display list on the machine, in all three ways.

use crate::common;
pub use crate::common::{Ran, replay, scene_front};
use basrelief_frame_buffer::FinishedFrame;
use basrelief_kernel::Engine;
use basrelief_machines::UnitStats;
use basrelief_machines::shade::{FigureShadingDevice, FrontEnd, ShadeConfig};
use basrelief_signals::{Control, Scene};
use std::sync::Arc;

/// The default machine with these settings.
pub fn config(settings: &[(&str, &str)]) -> ShadeConfig {
    common::config(settings)
}

/// A demo, small.
pub fn small_demo(name: &str) -> Arc<Scene> {
    common::small_demo(name, 1)
}

pub fn machine<F: FrontEnd>(front: F, config: &ShadeConfig) -> FigureShadingDevice<F> {
    FigureShadingDevice::new(front, config).unwrap_or_else(|e| panic!("{e}"))
}

pub fn run(front: impl FrontEnd, config: &ShadeConfig, engine: Engine) -> Ran {
    common::run(machine(front, config), engine)
}

/// A timed run that must come to its end.
pub fn timed(controls: &[Control], settings: &[(&str, &str)]) -> Ran {
    let config = config(settings);
    common::timed(machine(replay(controls, &config), &config), settings)
}

/// Pictures and device figures of the functional model.
pub fn functional(front: impl FrontEnd, config: &ShadeConfig) -> (Vec<FinishedFrame>, UnitStats) {
    common::functional(machine(front, config))
}
