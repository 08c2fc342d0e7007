//! Running a scene or a display list on the machine, in all three ways.

use basrelief_frame_buffer::FinishedFrame;
use basrelief_geometry_processor::SceneDraws;
use basrelief_kernel::{Engine, Limits, NoProbe, Outcome, RunReport, run_functional, run_with};
use basrelief_machines::Counts;
use basrelief_machines::texel::{FrontEnd, SceneFront, TexelMachineConfig, TextureMappingSystem, TraceFront};
use basrelief_parameters::load;
use basrelief_scene::{ViewOptions, demo};
use basrelief_signals::{Control, Scene};
use std::sync::Arc;

/// What a run came to.
pub struct Ran {
    pub report: RunReport,
    pub frames: Vec<FinishedFrame>,
    pub counts: Counts,
}

impl Ran {
    pub fn count(&self, name: &str) -> u64 {
        assert!(self.counts.iter().any(|(n, _)| n == name), "there is no device figure `{name}`");
        self.counts.number(name)
    }
}

/// The default machine with these settings.
pub fn config(settings: &[(&str, &str)]) -> TexelMachineConfig {
    load("", settings).unwrap_or_else(|e| panic!("{e}"))
}

/// A demo, small.
pub fn small_demo(name: &str) -> Arc<Scene> {
    let options = ViewOptions { size: [64, 48], frames: Some(1), ..ViewOptions::default() };
    Arc::new(demo(name, &options).unwrap_or_else(|e| panic!("{e}")))
}

/// A way in that replays these commands.
pub fn replay(controls: &[Control], config: &TexelMachineConfig) -> impl FrontEnd + use<> {
    let commands: Vec<_> = controls.iter().map(|c| Ok::<_, String>((c.clone(), None))).collect();
    TraceFront::new(commands.into_iter(), config)
}

/// A way in that draws this scene.
pub fn scene_front(scene: &Arc<Scene>, config: &TexelMachineConfig) -> impl FrontEnd + use<> {
    SceneFront::new(SceneDraws::new(Arc::clone(scene)), config)
}

pub fn run(front: impl FrontEnd, config: &TexelMachineConfig, engine: Engine) -> Ran {
    let mut machine = TextureMappingSystem::new(front, config).unwrap_or_else(|e| panic!("{e}"));
    let report = run_with(&mut machine, engine, &mut NoProbe, Limits { max_cycles: u64::MAX, progress: &mut |_| true });
    Ran { report, frames: machine.drain_finished(), counts: machine.counts() }
}

/// A timed run that must come to its end.
pub fn timed(controls: &[Control], settings: &[(&str, &str)]) -> Ran {
    let config = config(settings);
    let ran = run(replay(controls, &config), &config, Engine::Timed);
    assert_eq!(ran.report.outcome, Outcome::Complete, "{settings:?}");
    ran
}

/// Pictures and device figures of the functional model.
pub fn functional(front: impl FrontEnd, config: &TexelMachineConfig) -> (Vec<FinishedFrame>, Counts) {
    let mut machine = TextureMappingSystem::new(front, config).unwrap_or_else(|e| panic!("{e}"));
    run_functional(&mut machine, &mut |_| true).unwrap_or_else(|fault| panic!("{fault}"));
    (machine.drain_finished(), machine.counts())
}

/// A figure that is no whole number.
pub fn figure(counts: &Counts, name: &str) -> f64 {
    let found = counts.iter().find(|(n, _)| *n == name).and_then(|(_, value)| value.as_f64());
    found.unwrap_or_else(|| panic!("there is no device figure `{name}`"))
}
