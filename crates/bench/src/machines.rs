//! The machines on fixed scenes.
//!
//! | workload | machine | scene |
//! |---|---|---|
//! | W1 | `bump` | `sphere`: 20,000 triangles, 640 x 480, normal map of 512 x 512 bilinear, two levels, 256 entries |
//! | W2 | `bump` | `brick`: wall and floor to the horizon, 640 x 480 |
//! | W3 | `bump` | one plane that fills 1920 x 1080 |
//! | W4 | `shade` | `goblet`, 640 x 480 |
//! | W5 | `texel` | `corridor`: floor, walls and ceiling to the vanishing point, 640 x 480, adaptive |
//! | W6 | `defer` | `gallery`: one view of the hall with 34 pictures, 640 x 480, mode best |
//!
//! All parts are modelled, with the machines' defaults. Only the simulation is measured: scene, reference image and metrics are
//! made outside.

use crate::stopwatch::{UnitTime, unit_times};
use crate::workload::{RunSample, ThroughputUnit, Workload, WorkloadSize, measured};
use basrelief_geometry_processor::SceneDraws;
use basrelief_kernel::recording::RecordingChunk;
use basrelief_kernel::{
    Engine, Machine, Netlist, NoProbe, Outcome, PathMemory, Probe, Recording, RunLimits, RunReport, resimulate, run_functional,
    run_recorded, run_with,
};
use basrelief_machines::bump::{BumpProcessor, BumpProcessorConfig};
use basrelief_machines::defer::{DeferConfig, DeferredRenderer};
use basrelief_machines::shade::{FigureShadingDevice, ShadeConfig};
use basrelief_machines::texel::{TexelMachineConfig, TextureMappingSystem};
use basrelief_machines::{ConfigProblem, PictureMachine, SceneFront};
use basrelief_parameters::Parameters;
use basrelief_scene::{ViewOptions, demo};
use basrelief_signals::{Mesh, Object, Scene};
use basrelief_sim::{MachineConfig, run_concurrent};
use basrelief_timeline::TimelineLayout;
use std::borrow::Cow;
use std::sync::Arc;

/// Settings of a machine by dotted name.
pub type SettingList = &'static [(&'static str, &'static str)];

/// A scene, and the machine that draws it.
#[derive(Clone, Debug)]
pub struct MachineScene {
    /// The scene.
    pub scene: Arc<Scene>,
    config: MachineConfig,
}

/// Job for a machine in its power-on state.
trait MachineJob {
    type Result;
    fn with<M: Machine>(self, machine: &mut M) -> Self::Result;
}

impl MachineScene {
    /// Creates W1.
    pub fn w1(size: WorkloadSize, set: SettingList) -> Self {
        Self::bump(demo_scene("sphere", size.of([640, 480], [128, 96])), set)
    }

    /// Creates W2.
    pub fn w2(size: WorkloadSize, set: SettingList) -> Self {
        Self::bump(demo_scene("brick", size.of([640, 480], [128, 96])), set)
    }

    /// Creates W3.
    pub fn w3(size: WorkloadSize, set: SettingList) -> Self {
        Self::bump(plane(size.of([1920, 1080], [160, 90])), set)
    }

    /// Creates W4.
    pub fn w4(size: WorkloadSize, set: SettingList) -> Self {
        let scene = demo_scene(size.of("goblet", "goblet@1"), size.of([640, 480], [160, 120]));
        Self { scene: Arc::new(scene), config: load::<ShadeConfig>(set) }
    }

    /// Creates W5.
    pub fn w5(size: WorkloadSize, set: SettingList) -> Self {
        let scene = demo_scene("corridor", size.of([640, 480], [160, 120]));
        Self { scene: Arc::new(scene), config: load::<TexelMachineConfig>(set) }
    }

    /// Creates W6.
    pub fn w6(size: WorkloadSize, set: SettingList) -> Self {
        // The small size uses another scene too, because creating the gallery's pictures takes longer than rendering it.
        let scene = demo_scene(size.of("gallery", "corridor"), size.of([640, 480], [160, 120]));
        Self { scene: Arc::new(scene), config: load::<DeferConfig>(set) }
    }

    fn bump(scene: Scene, set: SettingList) -> Self {
        Self { scene: Arc::new(scene), config: load::<BumpProcessorConfig>(set) }
    }

    /// Runs the job. Also returns the fragments of the machine.
    fn work<J: MachineJob>(&self, job: J) -> (J::Result, u64) {
        let draws = SceneDraws::new(Arc::clone(&self.scene));
        match &self.config {
            MachineConfig::Bump(config) => done(job, BumpProcessor::new(SceneFront::new(draws, config), config)),
            MachineConfig::Shade(config) => done(job, FigureShadingDevice::new(SceneFront::new(draws, config), config)),
            MachineConfig::Texel(config) => done(job, TextureMappingSystem::new(SceneFront::new(draws, config), config)),
            MachineConfig::Defer(config) => done(job, DeferredRenderer::new(SceneFront::new(draws, config), config)),
        }
    }

    /// Simulates the drawing, on an engine or without time.
    pub fn simulate<P: Probe>(&self, engine: Option<Engine>, probe: &mut P) -> RunSample {
        let (time, count) = self.work(SimulateMachine { engine, probe });
        RunSample { time, count }
    }

    /// Simulates the drawing with execution on one thread and timing on another.
    ///
    /// # Panics
    /// Panics on a single core.
    pub fn simulate_apart(&self) -> RunSample {
        let (time, count) = self.work(SimulateOnTwoThreads);
        RunSample { time, count }
    }

    /// Returns time and steps of every unit in the functional model.
    pub fn unit_times(&self) -> Vec<UnitTime> {
        self.work(TimeUnits).0
    }

    /// Returns the machine's layout in a timeline.
    pub fn board(&self) -> TimelineLayout {
        self.work(ShowBoard).0
    }
}

struct SimulateMachine<'a, P> {
    engine: Option<Engine>,
    probe: &'a mut P,
}

impl<P: Probe> MachineJob for SimulateMachine<'_, P> {
    type Result = std::time::Duration;

    fn with<M: Machine>(self, machine: &mut M) -> Self::Result {
        let Self { engine, probe } = self;
        let (complete, time) = measured(|| match engine {
            None => run_functional(machine, &mut |_| true).is_ok(),
            Some(engine) => {
                let limits = RunLimits { max_cycles: u64::MAX, progress: &mut |_| true };
                run_with(machine, engine, probe, limits).outcome == Outcome::Complete
            }
        });
        assert!(complete, "a workload runs to its end");
        time
    }
}

/// Job that simulates a machine on two threads.
struct SimulateOnTwoThreads;

impl MachineJob for SimulateOnTwoThreads {
    type Result = std::time::Duration;

    fn with<M: Machine>(self, machine: &mut M) -> Self::Result {
        let (report, time) = measured(|| run_concurrent(machine, &mut |_| true, None));
        assert_eq!(report.expect("there are two cores").outcome, Outcome::Complete, "a workload runs to its end");
        time
    }
}

/// Job that records a machine.
struct RecordMachine;

impl MachineJob for RecordMachine {
    type Result = (Netlist, Vec<RecordingChunk>);

    fn with<M: Machine>(self, machine: &mut M) -> Self::Result {
        let shape = Netlist::of(machine).expect("the machines are wired");
        let mut chunks = Vec::new();
        let limits = RunLimits { max_cycles: u64::MAX, progress: &mut |_: &mut M| true };
        let report = run_recorded(machine, Engine::Timed, &mut NoProbe, limits, (1 << 20, &mut |reel| chunks.push(reel)));
        assert_eq!(report.outcome, Outcome::Complete, "a workload runs to its end");
        (shape, chunks)
    }
}

struct TimeUnits;

impl MachineJob for TimeUnits {
    type Result = Vec<UnitTime>;

    fn with<M: Machine>(self, machine: &mut M) -> Self::Result {
        unit_times(machine)
    }
}

struct ShowBoard;

impl MachineJob for ShowBoard {
    type Result = TimelineLayout;

    fn with<M: Machine>(self, machine: &mut M) -> Self::Result {
        TimelineLayout::new("machine", 0, Netlist::of(machine).expect("its wiring was checked when it was built").diagram())
    }
}

/// Runs the job with a machine. Also returns its fragments.
fn done<J: MachineJob, M: PictureMachine>(job: J, machine: Result<M, ConfigProblem>) -> (J::Result, u64) {
    let mut machine = machine.expect("what the workloads set fits the defaults");
    (job.with(&mut machine), machine.facts().count("fragments"))
}

fn load<C: Parameters>(set: SettingList) -> MachineConfig
where
    MachineConfig: From<C>,
{
    basrelief_parameters::load::<C>("", set).expect("the workloads set parameters that there are").into()
}

/// Creates a demo scene.
pub fn demo_scene(name: &str, size: [u32; 2]) -> Scene {
    demo(name, &ViewOptions { size, ..ViewOptions::default() }).expect("the demo is there")
}

/// Creates one plane that fills the picture, in the material of W1.
fn plane(size: [u32; 2]) -> Scene {
    let Scene { mut objects, mut frames, warnings, .. } = demo_scene("sphere", size);
    let mesh = Mesh {
        positions: vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
        normals: vec![[0.0, 0.0, 1.0]; 4],
        tangents: vec![[1.0, 0.0, 0.0, 1.0]; 4],
        uv_normal: vec![[0.0, 2.25], [4.0, 2.25], [4.0, 0.0], [0.0, 0.0]],
        indices: vec![0, 1, 2, 0, 2, 3],
        ..Mesh::default()
    };
    for object in &mut objects {
        let Object { id, material, .. } = (**object).clone();
        *object = Arc::new(Object {
            id,
            name: "plane".into(),
            mesh: Arc::new(mesh.clone()),
            world: IDENTITY,
            material,
            entries: None,
            bias: None,
            bump: None,
            shading: Default::default(),
        });
    }
    frames.iter_mut().for_each(|frame| Arc::make_mut(frame).camera.view_projection = IDENTITY);
    Scene { name: "plane".into(), objects, frames, warnings }
}

const IDENTITY: [f64; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// Name of a workload, and its constructor.
type WorkloadMaker = (&'static str, fn(WorkloadSize, SettingList) -> MachineScene);

const MAKE: [WorkloadMaker; 6] = [
    ("w1", MachineScene::w1),
    ("w2", MachineScene::w2),
    ("w3", MachineScene::w3),
    ("w4", MachineScene::w4),
    ("w5", MachineScene::w5),
    ("w6", MachineScene::w6),
];

/// Returns the machines with and without time.
pub fn workloads(size: WorkloadSize) -> Vec<Workload> {
    let workload = |(name, make): WorkloadMaker, engine: Option<Engine>| {
        let mode = if engine.is_some() { "timed" } else { "functional" };
        Workload::new(format!("machine/{name}/{mode}"), ThroughputUnit::Fragments, move || {
            let drawing = make(size, &[]);
            move || drawing.simulate(engine, &mut NoProbe)
        })
    };
    let runs = MAKE.into_iter().flat_map(|make| [Some(Engine::Timed), None].map(|engine| workload(make, engine)));
    runs.chain([Retiming::WhileRead, Retiming::Again, Retiming::Path].map(|how| retimed(size, how))).collect()
}

/// FIFOs as bottleneck analysis relaxes them.
const DEEP_FIFOS: SettingList = &[
    ("fifo.bump_fragments.depth", "65536"),
    ("fifo.pseudo_normals.depth", "65536"),
    ("fifo.indexes.depth", "65536"),
    ("fifo.shaded.depth", "65536"),
];

/// A way to resimulate a recording of W1.
#[derive(Clone, Copy, Debug)]
enum Retiming {
    /// Timed while it is read.
    WhileRead,
    /// Timed again.
    Again,
    /// As `Again`, with deep FIFOs and the critical path.
    Path,
}

/// Returns a resimulation of W1's recording.
fn retimed(size: WorkloadSize, how: Retiming) -> Workload {
    let (name, set): (_, SettingList) = match how {
        Retiming::WhileRead => ("machine/w1/retimed", &[]),
        Retiming::Again => ("machine/w1/retimed-again", &[]),
        Retiming::Path => ("machine/w1/critical-path", DEEP_FIFOS),
    };
    Workload::new(name, ThroughputUnit::Fragments, move || {
        let ((shape, chunks), count) = MachineScene::w1(size, set).work(RecordMachine);
        let recording = Recording::new(chunks.clone(), &shape, u64::MAX);
        let time_again = move |shape: Netlist| {
            let mut chunks = chunks.iter().map(Cow::Borrowed);
            let is_complete = |report: RunReport| report.outcome == Outcome::Complete;
            let timed = match how {
                Retiming::WhileRead => resimulate(shape, &mut |_| Ok(chunks.next()), &mut NoProbe, u64::MAX).map(is_complete),
                Retiming::Again => recording.resimulate(shape).map(is_complete),
                Retiming::Path => {
                    recording.critical_path(shape, usize::MAX, &[], &mut PathMemory::default()).map(|path| path.is_some())
                }
            };
            assert_eq!(timed, Ok(true), "a recording is complete");
        };
        time_again(shape.clone());
        move || {
            let ((), time) = measured(|| time_again(shape.clone()));
            RunSample { time, count }
        }
    })
}

/// Returns every unit alone, with each machine on one workload.
pub fn units() -> Vec<Workload> {
    let of = |(name, make): WorkloadMaker| {
        let drawing = make(WorkloadSize::Full, &[]);
        let stages = drawing.board().diagram.stages.into_iter().enumerate();
        stages.map(move |(i, stage)| {
            let drawing = drawing.clone();
            Workload::new(format!("unit/{name}/{}", stage.name), ThroughputUnit::Steps, move || {
                let drawing = drawing.clone();
                move || {
                    let UnitTime { time, steps } = drawing.unit_times()[i];
                    RunSample { time, count: steps }
                }
            })
        })
    };
    [MAKE[0], MAKE[3], MAKE[4], MAKE[5]].into_iter().flat_map(of).collect()
}
