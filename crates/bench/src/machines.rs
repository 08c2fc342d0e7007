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
use basrelief_kernel::{Netlist, Outcome, Probe, Recording, ResimulationMemory, RunReport, resimulate};
use basrelief_machines::bump::BumpProcessorConfig;
use basrelief_machines::defer::DeferConfig;
use basrelief_machines::shade::ShadeConfig;
use basrelief_machines::texel::TexelMachineConfig;
use basrelief_machines::{FrontEnd, MachineSpec as _, for_machine};
use basrelief_parameters::Parameters;
use basrelief_scene::{ViewOptions, demo};
use basrelief_signals::{Mesh, Object, Scene};
use basrelief_sim::{BareMachine, MachineConfig, bare_machine};
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

    fn machine(&self) -> Box<dyn BareMachine> {
        bare_machine(&self.config, &self.scene).expect(FITS)
    }

    /// Measures a run of the machine, which must be complete.
    fn measure(&self, run: impl FnOnce(&mut dyn BareMachine) -> bool) -> RunSample {
        let mut machine = self.machine();
        let (is_complete, time) = measured(|| run(&mut *machine));
        assert!(is_complete, "a workload runs to its end");
        RunSample { time, count: machine.fragments() }
    }

    /// Simulates the drawing on the timed engine.
    pub fn simulate(&self, probe: Option<&mut dyn Probe>) -> RunSample {
        self.measure(|machine| machine.run(probe).outcome == Outcome::Complete)
    }

    /// Simulates the drawing without time.
    pub fn simulate_functional(&self) -> RunSample {
        self.measure(|machine| machine.run_functional().is_ok())
    }

    /// Simulates the drawing with execution on one thread and timing on another.
    ///
    /// # Panics
    /// Panics on a single core.
    pub fn simulate_concurrent(&self) -> RunSample {
        self.measure(|machine| machine.run_concurrent().expect("there are two cores").outcome == Outcome::Complete)
    }

    /// Returns the netlist of the machine, a recording of its run, and its fragments.
    fn record(&self) -> (Netlist, Vec<RecordingChunk>, u64) {
        let mut machine = self.machine();
        let (shape, mut chunks) = (machine.netlist().expect("the machines are wired"), Vec::new());
        let report = machine.run_recorded(1 << 20, &mut |chunk| chunks.push(chunk));
        assert_eq!(report.outcome, Outcome::Complete, "a workload runs to its end");
        (shape, chunks, machine.fragments())
    }

    /// Returns time and steps of every unit in the functional model.
    pub fn unit_times(&self) -> Vec<UnitTime> {
        let draws = SceneDraws::new(Arc::clone(&self.scene));
        for_machine!(&self.config, spec => unit_times(&mut spec.build(FrontEnd::of_scene(draws, spec.front())).expect(FITS)))
    }

    /// Returns the machine's layout in a timeline.
    pub fn board(&self) -> TimelineLayout {
        let shape = self.machine().netlist().expect("its wiring was checked when it was built");
        TimelineLayout::new("machine", 0, shape.diagram())
    }
}

const FITS: &str = "what the workloads set fits the defaults";

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
    let workload = |(name, make): WorkloadMaker, is_timed: bool| {
        let mode = if is_timed { "timed" } else { "functional" };
        Workload::new(format!("machine/{name}/{mode}"), ThroughputUnit::Fragments, move || {
            let drawing = make(size, &[]);
            move || if is_timed { drawing.simulate(None) } else { drawing.simulate_functional() }
        })
    };
    let runs = MAKE.into_iter().flat_map(|make| [true, false].map(|is_timed| workload(make, is_timed)));
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
        let (shape, chunks, count) = MachineScene::w1(size, set).record();
        let recording = Recording::new(chunks.clone(), &shape, u64::MAX);
        let time_again = move |shape: Netlist| {
            let mut chunks = chunks.iter().map(Cow::Borrowed);
            let is_complete = |report: RunReport| report.outcome == Outcome::Complete;
            let timed = match how {
                Retiming::WhileRead => resimulate(shape, &mut |_| Ok(chunks.next()), u64::MAX).map(is_complete),
                Retiming::Again => recording.resimulate(shape, &mut ResimulationMemory::default()).map(is_complete),
                Retiming::Path => {
                    recording.critical_path(shape, usize::MAX, &[], &mut ResimulationMemory::default()).map(|path| path.is_some())
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
