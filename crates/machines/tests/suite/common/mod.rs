//! Shared code of the machines' tests: runs on both engines and the functional model, and random settings.

pub mod machine_runs;
pub mod settings;
pub mod trace;

use basrelief_frame_buffer::FinishedFrame;
use basrelief_geometry_processor::SceneDraws;
use basrelief_kernel::{Engine, Outcome, Probe, RunLimits, RunReport};
use basrelief_machines::bump::{BumpProcessor, BumpProcessorConfig};
use basrelief_machines::{FrontConfig, FrontEnd, PictureMachine, UnitStats};
use basrelief_parameters::{Parameters, load};
use basrelief_scene::{ViewOptions, demo};
use basrelief_signals::{Control, Scene};
use std::sync::Arc;

/// Result of a run.
pub struct Ran {
    pub report: RunReport,
    pub frames: Vec<FinishedFrame>,
    pub facts: UnitStats,
}

impl Ran {
    pub fn count(&self, name: &str) -> u64 {
        count(&self.facts, name)
    }

    /// Returns the bytes that a client read and wrote.
    pub fn bytes(&self, client: &str) -> u64 {
        let ports = self.report.memories.iter().flat_map(|m| &m.ports);
        ports.filter(|p| p.client == client).map(|p| p.counts.read_bytes + p.counts.write_bytes).sum()
    }

    /// Returns the largest difference of 8-bit values.
    pub fn difference(&self, other: &Self) -> u8 {
        assert_eq!(self.frames.len(), other.frames.len());
        let pairs = self.frames.iter().zip(&other.frames).flat_map(|(a, b)| {
            assert_eq!(a.covered, b.covered);
            a.rgb.iter().zip(&b.rgb)
        });
        pairs.flat_map(|(a, b)| (0..3).map(|i| a[i].abs_diff(b[i]))).max().unwrap_or(0)
    }
}

/// Returns a figure that must exist.
pub fn count(facts: &UnitStats, name: &str) -> u64 {
    assert!(facts.get(name).is_some(), "there is no figure `{name}`");
    facts.count(name)
}

/// Loads a machine's defaults with these settings.
pub fn config<C: Parameters>(settings: &[(&str, &str)]) -> C {
    load("", settings).unwrap_or_else(|e| panic!("{e}"))
}

/// Loads a demo at a small size.
pub fn small_demo(name: &str, frames: u32) -> Arc<Scene> {
    let options = ViewOptions { size: [64, 48], frames: Some(frames), ..ViewOptions::default() };
    Arc::new(demo(name, &options).unwrap_or_else(|e| panic!("{e}")))
}

/// Creates a front end that replays these commands.
pub fn replay(controls: &[Control], config: impl Into<FrontConfig>) -> FrontEnd {
    let commands: Vec<_> = controls.iter().map(|c| Ok((c.clone(), None))).collect();
    FrontEnd::of_trace(commands.into_iter(), config)
}

/// Creates a front end that draws this scene.
pub fn scene_front(scene: &Arc<Scene>, config: impl Into<FrontConfig>) -> FrontEnd {
    FrontEnd::of_scene(SceneDraws::new(Arc::clone(scene)), config)
}

/// Runs a machine, with a probe if there is one.
pub fn run_probed(mut machine: impl PictureMachine, engine: Engine, probe: Option<&mut dyn Probe>) -> Ran {
    let report = machine.run_with(engine, probe, RunLimits { max_cycles: u64::MAX, progress: &mut |_| true });
    Ran { report, frames: machine.drain_finished(), facts: machine.facts() }
}

/// Runs a machine.
pub fn run(machine: impl PictureMachine, engine: Engine) -> Ran {
    run_probed(machine, engine, None)
}

/// Runs the timed engine, and asserts that the run finishes.
pub fn timed(machine: impl PictureMachine, settings: &[(&str, &str)]) -> Ran {
    let ran = run(machine, Engine::Timed);
    assert_eq!(ran.report.outcome, Outcome::Complete, "{settings:?}");
    ran
}

/// Returns pictures and figures of the functional model.
pub fn functional(mut machine: impl PictureMachine) -> (Vec<FinishedFrame>, UnitStats) {
    machine.run_functional(&mut |_| true).unwrap_or_else(|fault| panic!("{fault}"));
    (machine.drain_finished(), machine.facts())
}

/// Returns the pixels that the bump-mapping processor covers.
pub fn covered_by_bump(list: &[Control]) -> Vec<Vec<bool>> {
    let config = BumpProcessorConfig::default();
    let machine = BumpProcessor::new(replay(list, &config), &config).expect("defaults fit");
    functional(machine).0.into_iter().map(|f| f.covered).collect()
}

/// Runs both engines and the functional model, asserts that they agree, and returns the timed run.
pub fn agree<M: PictureMachine>(machine: impl Fn() -> M) -> Ran {
    let timed = run(machine(), Engine::Timed);
    assert_eq!(timed.report.outcome, Outcome::Complete);
    let ticked = run(machine(), Engine::Ticked);
    same(&timed.report, &ticked.report);
    assert_eq!((&timed.frames, &timed.facts), (&ticked.frames, &ticked.facts));
    let (frames, facts) = functional(machine());
    assert_eq!((&timed.frames, &timed.facts), (&frames, &facts), "the functional model");
    conserved(&timed.report);
    timed
}

/// Asserts that reports are equal. The message contains only the parts that differ.
pub fn same(timed: &RunReport, ticked: &RunReport) {
    fn differ<T: PartialEq + std::fmt::Debug>(timed: &[T], ticked: &[T]) -> String {
        timed.iter().zip(ticked).filter(|(a, b)| a != b).map(|(a, b)| format!("timed {a:?}\nticked {b:?}\n")).collect()
    }
    if timed != ticked {
        let parts = [
            differ(&[&timed.outcome], &[&ticked.outcome]),
            differ(&[(timed.total, &timed.marks)], &[(ticked.total, &ticked.marks)]),
            differ(&timed.units, &ticked.units),
            differ(&timed.fifos, &ticked.fifos),
            differ(&timed.memories, &ticked.memories),
            differ(&timed.caches, &ticked.caches),
        ];
        panic!("the engines differ:\n{}", parts.concat());
    }
}

/// Asserts laws 9 and 10: cycles of units and FIFOs sum to the total.
pub fn conserved(report: &RunReport) {
    for unit in &report.units {
        assert_eq!(unit.account.total(), report.total, "cycles of {}", unit.name);
    }
    for fifo in &report.fifos {
        assert_eq!(fifo.histogram.iter().sum::<u64>(), report.total, "histogram of {}", fifo.name);
        assert_eq!(fifo.histogram.len(), fifo.depth + 1, "{}", fifo.name);
        assert!(fifo.high_water() <= fifo.depth);
    }
}
