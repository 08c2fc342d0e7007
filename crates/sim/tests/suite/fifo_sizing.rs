//! FIFO sizing on all machines: every choice keeps its tolerance and has no spare slot.

use crate::common::{CollectedRecording, demo_scene};
use basrelief_input::MemoryPool;
use basrelief_report::model::OutcomeKind;
use basrelief_scene::ViewOptions;
use basrelief_sim::{
    AnalysisPolicy, DepthChoice, MACHINES, MachineInfo, Overrides, PreparedScene, ResimulateOptions, RunInput, RunOptions,
    resimulate, run, size_fifos,
};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::Cursor;

/// Returns the first demo of a machine, small, with everything that its runs share.
fn small_demo(machine: &MachineInfo) -> PreparedScene {
    let options = ViewOptions { size: [16, 12], frames: Some(1), ..ViewOptions::default() };
    PreparedScene::cached(demo_scene(machine.demos[0], &options), &MemoryPool::default())
}

/// Runs a scene with these settings. Returns the render cycles, `None` if the run does not finish, and the recording if requested.
fn ran(
    machine: &MachineInfo,
    scene: &PreparedScene,
    settings: &[(String, String)],
    recording: AnalysisPolicy,
) -> (Option<u64>, Vec<u8>) {
    let overrides = Overrides { toml: String::new(), settings: settings.to_vec() };
    let config = overrides.config(machine, &[]).unwrap();
    let run_options =
        RunOptions { config, exact: false, bottlenecks: AnalysisPolicy::Never, overrides, recording, ..RunOptions::default() };
    let mut kept = CollectedRecording::default();
    let report = run(RunInput::Scene(scene.clone()), &run_options, &mut kept, None).ok().map(|run| run.report);
    (report.filter(|report| report.outcome.kind == OutcomeKind::Complete).map(|report| report.frame_cycles()), kept.0)
}

fn recording(machine: &MachineInfo, scene: &PreparedScene, settings: &[(String, String)]) -> Vec<u8> {
    ran(machine, scene, settings, AnalysisPolicy::Always).1
}

fn settings(depths: &[(String, u32)]) -> Vec<(String, String)> {
    depths.iter().map(|(name, depth)| (format!("fifo.{name}.depth"), depth.to_string())).collect()
}

/// Depths of FIFOs by name.
type Depths = Vec<(String, u32)>;

/// Full runs of one scene, each depth once.
struct FullRuns {
    machine: &'static MachineInfo,
    scene: PreparedScene,
    known: RefCell<BTreeMap<Depths, Option<u64>>>,
}

impl FullRuns {
    /// Returns the render cycles of a full run with these depths; `None` if the run does not finish.
    fn cycles(&self, depths: &[(String, u32)]) -> Option<u64> {
        let known = self.known.borrow().get(depths).copied();
        let cycles = known.unwrap_or_else(|| ran(self.machine, &self.scene, &settings(depths), AnalysisPolicy::Never).0);
        self.known.borrow_mut().insert(depths.to_vec(), cycles);
        cycles
    }
}

/// Returns the render cycles of the recorded steps with these depths.
fn resimulated_cycles(recording: &[u8], depths: &[(String, u32)]) -> u64 {
    let options = ResimulateOptions { settings: settings(depths), ..ResimulateOptions::default() };
    resimulate(&mut Cursor::new(recording), &options).unwrap().frame_cycles()
}

fn with_one_less(depths: &[(String, u32)], n: usize) -> Vec<(String, u32)> {
    let mut fewer = depths.to_vec();
    fewer[n].1 -= 1;
    fewer
}

// Claim: analysis: In each choice of `size-fifos`, one slot less in any FIFO exceeds the tolerance.
#[test]
fn sized_fifos_have_no_spare_slot() {
    for machine in MACHINES {
        let scene = small_demo(machine);
        let recording = recording(machine, &scene, &[]);
        let runs = FullRuns { machine, scene, known: RefCell::default() };
        let sizing = size_fifos(vec![&mut Cursor::new(&recording)], &[0.0, 1.0], &MemoryPool::default()).unwrap();
        let [recorded, found @ ..] = sizing.choices.as_slice() else { panic!("{sizing:?}") };
        for DepthChoice { within_percent, depths, least_alone, area_ge, cycles: promised, .. } in found {
            let most = recorded.cycles[0] as f64 * (1.0 + within_percent.unwrap() / 100.0);
            let keeps = |depths: &[(String, u32)]| runs.cycles(depths).is_some_and(|cycles| cycles as f64 <= most);
            assert_eq!(runs.cycles(depths), Some(promised[0]), "{}", machine.name);
            assert_eq!(
                resimulated_cycles(&recording, depths),
                promised[0],
                "{}: other hardware, but no other work",
                machine.name
            );
            assert!(keeps(depths), "{}: {depths:?} of {:?}", machine.name, recorded.depths);
            assert!(*area_ge <= recorded.area_ge, "{}: {depths:?} have {area_ge} GE", machine.name);
            for n in 0..depths.len() {
                assert!(depths[n].1 == 1 || !keeps(&with_one_less(depths, n)), "{}: {:?}", machine.name, depths[n]);
                let mut alone = recorded.depths.clone();
                alone[n] = least_alone[n].clone();
                assert!(keeps(&alone), "{}: {:?} alone", machine.name, alone[n]);
                assert!(alone[n].1 == 1 || !keeps(&with_one_less(&alone, n)), "{}: {:?} alone", machine.name, alone[n]);
            }
        }
    }
}

#[test]
fn recordings_of_other_parameters_name_the_difference() {
    let bump = &MACHINES[0];
    let scene = small_demo(bump);
    let first = recording(bump, &scene, &[]);
    let second = recording(bump, &scene, &[("fifo.shaded.depth".into(), "3".into())]);
    let shade = recording(MachineInfo::named("shade").unwrap(), &scene, &[]);
    let error = |mut other: &[u8]| {
        let mut one = &first[..];
        size_fifos(vec![&mut one, &mut other], &[0.1], &MemoryPool::default()).unwrap_err().to_string()
    };
    assert!(error(&second).starts_with("`fifo.shaded.depth` is 3, expected "), "{}", error(&second));
    assert!(error(&shade).starts_with("the machine is `shade`, expected `bump` as in the first input"), "{}", error(&shade));
}

/// The combiner holds back reads of lines that are on their way to memory, and FIFO `pixels` is a part of that way.
#[test]
fn depth_that_changes_work_stays_as_recorded() {
    let texel = MachineInfo::named("texel").unwrap();
    let scene = small_demo(texel);
    let sized = |mode: &str| {
        let recording = recording(texel, &scene, &[("combiner.mode".into(), mode.into())]);
        size_fifos(vec![&mut Cursor::new(&recording)], &[10.0], &MemoryPool::default()).unwrap()
    };
    let has_pixels = |sizing: &basrelief_sim::FifoSizing| sizing.choices[0].depths.iter().any(|(name, _)| name == "pixels");
    let (blended, replaced) = (sized("blend"), sized("replace"));
    assert!(!has_pixels(&blended) && has_pixels(&replaced));
    assert_eq!(blended.warnings, ["`fifo.pixels.depth` stays as recorded, because the work of a unit depends on it"]);
    assert_eq!(replaced.warnings, [""; 0]);
}
