//! FIFO sizing on all machines: every choice keeps its tolerance and has no spare slot.

use crate::common::CollectedRecording;
use basrelief_input::MemoryPool;
use basrelief_report::model::OutcomeKind;
use basrelief_scene::{ViewOptions, demo};
use basrelief_sim::{AnalysisPolicy, DepthChoice, MACHINES, MachineInfo, Overrides, RunInput, RunOptions, run, size_fifos};
use std::io::Cursor;
use std::sync::Arc;

/// Runs the machine's first demo with these settings. Returns the render cycles, `None` if the run does not finish, and the recording.
fn ran(machine: &MachineInfo, settings: &[(String, String)]) -> (Option<u64>, Vec<u8>) {
    let options = ViewOptions { size: [24, 18], frames: Some(1), ..ViewOptions::default() };
    let overrides = Overrides { toml: String::new(), settings: settings.to_vec() };
    let config = overrides.config(machine, &[]).unwrap();
    let run_options = RunOptions {
        config,
        exact: false,
        bottlenecks: AnalysisPolicy::Never,
        overrides,
        recording: AnalysisPolicy::Always,
        ..RunOptions::default()
    };
    let mut kept = CollectedRecording::default();
    let scene = RunInput::scene(Arc::new(demo(machine.demos[0], &options).unwrap()));
    let report = run(scene, &run_options, &mut kept, None).ok().map(|run| run.report);
    (report.filter(|report| report.outcome.kind == OutcomeKind::Complete).map(|report| report.frame_cycles()), kept.0)
}

fn recording(machine: &MachineInfo, settings: &[(String, String)]) -> Vec<u8> {
    ran(machine, settings).1
}

fn settings(depths: &[(String, u32)]) -> Vec<(String, String)> {
    depths.iter().map(|(name, depth)| (format!("fifo.{name}.depth"), depth.to_string())).collect()
}

/// Returns the render cycles of a full run with these depths; `None` if the run does not finish.
fn cycles(machine: &MachineInfo, depths: &[(String, u32)]) -> Option<u64> {
    ran(machine, &settings(depths)).0
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
        let recording = recording(machine, &[]);
        let sizing = size_fifos(vec![&mut Cursor::new(&recording)], &[0.0, 1.0], &MemoryPool::default()).unwrap();
        let [recorded, found @ ..] = sizing.choices.as_slice() else { panic!("{sizing:?}") };
        for DepthChoice { within_percent, depths, least_alone, area_ge, cycles: promised, .. } in found {
            let most = recorded.cycles[0] as f64 * (1.0 + within_percent.unwrap() / 100.0);
            let keeps = |depths: &[(String, u32)]| cycles(machine, depths).is_some_and(|cycles| cycles as f64 <= most);
            assert_eq!(cycles(machine, depths), Some(promised[0]), "{}", machine.name);
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
    let (first, second) = (recording(bump, &[]), recording(bump, &[("fifo.shaded.depth".into(), "3".into())]));
    let shade = recording(MachineInfo::named("shade").unwrap(), &[]);
    let error = |mut other: &[u8]| {
        let mut one = &first[..];
        size_fifos(vec![&mut one, &mut other], &[0.1], &MemoryPool::default()).unwrap_err().to_string()
    };
    assert!(error(&second).starts_with("`fifo.shaded.depth` is 3, expected "), "{}", error(&second));
    assert!(error(&shade).starts_with("the machine is `shade`, expected `bump` as in the first input"), "{}", error(&shade));
}
