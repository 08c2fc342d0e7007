//! Running a scene on the machine, in all three ways.

use basrelief_frame_buffer::FinishedFrame;
use basrelief_geometry_processor::SceneDraws;
use basrelief_kernel::{Engine, Outcome, Probe, RunReport};
use basrelief_kernel::{Limits, NoProbe, run_functional, run_with};
use basrelief_machines::Counts;
use basrelief_machines::bump::{BumpProcessor, BumpProcessorConfig, SceneFront};
use basrelief_parameters::load;
use basrelief_scene::{ViewOptions, demo};
use basrelief_signals::Scene;
use std::sync::Arc;

/// What a run came to.
pub struct Ran {
    pub report: RunReport,
    pub frames: Vec<FinishedFrame>,
    pub counts: Counts,
}

impl Ran {
    /// Bytes that a client read and wrote.
    pub fn bytes(&self, client: &str) -> u64 {
        let ports = self.report.memories.iter().flat_map(|m| &m.ports);
        ports.filter(|p| p.client == client).map(|p| p.counts.read_bytes + p.counts.write_bytes).sum()
    }

    pub fn count(&self, name: &str) -> u64 {
        assert!(self.counts.iter().any(|(n, _)| n == name), "there is no device figure `{name}`");
        self.counts.number(name)
    }
}

/// The default machine with these settings.
pub fn config(settings: &[(&str, &str)]) -> BumpProcessorConfig {
    load("", settings).unwrap_or_else(|e| panic!("{e}"))
}

/// A demo, small.
pub fn small_demo(name: &str, frames: u32) -> Arc<Scene> {
    let options = ViewOptions { size: [64, 48], frames: Some(frames), ..ViewOptions::default() };
    Arc::new(demo(name, &options).unwrap_or_else(|e| panic!("{e}")))
}

pub fn machine(scene: &Arc<Scene>, config: &BumpProcessorConfig) -> BumpProcessor<SceneFront<SceneDraws>> {
    let front = SceneFront::new(SceneDraws::new(Arc::clone(scene)), config);
    BumpProcessor::new(front, config).unwrap_or_else(|e| panic!("{e}"))
}

pub fn run(scene: &Arc<Scene>, config: &BumpProcessorConfig, engine: Engine) -> Ran {
    run_probed(scene, config, engine, &mut NoProbe)
}

pub fn run_probed<P: Probe>(scene: &Arc<Scene>, config: &BumpProcessorConfig, engine: Engine, probe: &mut P) -> Ran {
    let mut machine = machine(scene, config);
    let report = run_with(&mut machine, engine, probe, Limits { max_cycles: u64::MAX, progress: &mut |_| true });
    Ran { report, frames: machine.drain_finished(), counts: machine.counts() }
}

/// A timed run that must come to its end.
pub fn timed(scene: &Arc<Scene>, settings: &[(&str, &str)]) -> Ran {
    let ran = run(scene, &config(settings), Engine::Timed);
    assert_eq!(ran.report.outcome, Outcome::Complete, "{settings:?}");
    ran
}

/// Pictures and device figures of the functional model.
pub fn functional(scene: &Arc<Scene>, config: &BumpProcessorConfig) -> (Vec<FinishedFrame>, Counts) {
    let mut machine = machine(scene, config);
    run_functional(&mut machine, &mut |_| true).unwrap_or_else(|fault| panic!("{fault}"));
    (machine.drain_finished(), machine.counts())
}
