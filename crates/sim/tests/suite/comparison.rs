//! Explanations of the difference of two runs, on all machines.

use crate::common::{CollectedRecording, demo_scene};
use basrelief_input::MemoryPool;
use basrelief_report::{MeasuredCauses, Report};
use basrelief_scene::ViewOptions;
use basrelief_sim::{
    AnalysisPolicy, ExplainOptions, MACHINES, MachineInfo, Overrides, RecordedRun, RecordingError, RunInput, RunOptions, run,
};
use std::io::Cursor;

type Settings = Vec<(String, String)>;

fn input(machine: &MachineInfo) -> RunInput {
    let options = ViewOptions { size: [40, 30], frames: Some(2), orbit_degrees: Some(20.0), ..ViewOptions::default() };
    RunInput::scene(demo_scene(machine.demos[0], &options))
}

fn settings(set: &[(&str, &str)]) -> Settings {
    set.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect()
}

fn recorded_with(machine: &MachineInfo, settings: &Settings) -> (Report, Vec<u8>) {
    let overrides = Overrides { toml: String::new(), settings: settings.clone() };
    let config = overrides.config(machine, &[]).unwrap();
    let options = RunOptions { config, exact: false, overrides, recording: AnalysisPolicy::Always, ..RunOptions::default() };
    let mut kept = CollectedRecording::default();
    let report = run(input(machine), &options, &mut kept, None).unwrap().report;
    (report, kept.0)
}

fn recorded_run((report, recording): &(Report, Vec<u8>)) -> RecordedRun {
    RecordedRun::read(report, &mut Cursor::new(recording), &MemoryPool::default()).unwrap()
}

/// Explains a difference; with more runs of the machine if `may_run`.
fn explain(machine: &'static MachineInfo, a: &(Report, Vec<u8>), b: &(Report, Vec<u8>), may_run: bool) -> Option<MeasuredCauses> {
    let open = || Some(input(machine));
    let budget = MemoryPool::default();
    let options = ExplainOptions { input: may_run.then_some(&open), progress: &|_, _| {}, budget: &budget };
    basrelief_sim::explain(&recorded_run(a), &recorded_run(b), &options)
}

/// Returns a change of each of several groups of parameters, and of the work.
fn changes(machine: &MachineInfo) -> Vec<(&'static str, Settings)> {
    let table = machine.parameters();
    let first = |kind: &str, ending: &str, value: &str| {
        let found = table.iter().find(|p| p.key.starts_with(kind) && p.key.ends_with(ending)).unwrap();
        vec![(found.key.clone(), value.to_owned())]
    };
    let unit = machine.units().swap_remove(1).name;
    let work =
        [("bump", "replacement.entries", "64"), ("shade", "shade.mode", "brightness"), ("texel", "texel.error_bound", "0.1")];
    let work = work.into_iter().find(|(name, ..)| *name == machine.name).map_or(("engine.latency", "900"), |(_, k, v)| (k, v));
    vec![
        ("memory", first("memory.", ".part", "sram")),
        ("cache", first("cache.", ".sets", "1")),
        ("fifo", first("fifo.", ".latency", "9")),
        ("ideal", vec![("ideal.units".into(), unit)]),
        ("work", vec![(work.0.into(), work.1.into())]),
    ]
}

/// Checks each effect against a full run, and that all effects sum to the difference.
fn check(machine: &MachineInfo, base: &Settings, a: &Report, b: &Report, explained: &MeasuredCauses) {
    for share in &explained.shares {
        let mut settings = base.clone();
        settings.extend(share.set.iter().map(|set| set.split_once('=').map(|(k, v)| (k.into(), v.into())).unwrap()));
        let promised = recorded_with(machine, &settings).0.frame_cycles();
        assert_eq!(Some(promised), share.cycles, "{}: {share:?}", machine.name);
        assert_eq!(share.by, Some(promised as i64 - a.frame_cycles() as i64));
    }
    let alone: i64 = explained.shares.iter().filter_map(|share| share.by).sum();
    let difference = b.frame_cycles() as i64 - a.frame_cycles() as i64;
    assert_eq!(alone + explained.together, difference, "{}: {explained:?}", machine.name);
    assert!(explained.shares.is_sorted_by(|x, y| x.by.map(i64::abs) >= y.by.map(i64::abs)), "largest first");
}

#[test]
fn effects_match_full_runs_and_sum_to_difference() {
    for machine in MACHINES {
        let all: Settings = changes(machine).into_iter().flat_map(|(_, settings)| settings).collect();
        let (a, b) = (recorded_with(machine, &vec![]), recorded_with(machine, &all));
        let explained = explain(machine, &a, &b, false).unwrap();
        let mut found: Vec<&str> = explained.shares.iter().map(|share| share.parameter.as_str()).collect();
        let mut keys: Vec<&str> = all.iter().map(|(key, _)| key.as_str()).collect();
        found.sort_unstable();
        keys.sort_unstable();
        assert_eq!(found, keys, "one cause per changed parameter, none for derived values");
        check(machine, &vec![], &a.0, &b.0, &explained);
    }
}

#[test]
fn single_change_explains_the_whole_difference() {
    for machine in MACHINES {
        let a = recorded_with(machine, &vec![]);
        for (_, settings) in changes(machine) {
            let b = recorded_with(machine, &settings);
            let explained = explain(machine, &a, &b, false).unwrap();
            assert_eq!((explained.shares.len(), explained.together), (1, 0), "{}: {explained:?}", machine.name);
            assert_eq!(explained.shares[0].parameter, settings[0].0);
            assert_eq!(explained.shares[0].cycles, Some(b.0.frame_cycles()));
        }
        assert_eq!(explain(machine, &a, &a, false).unwrap().shares, []);
    }
}

/// Changes of three work parameters, which multiply: entries, lanes and MIP levels.
fn three_work_parameters() -> [Settings; 2] {
    [
        settings(&[("replacement.entries", "128"), ("replacement.lanes", "64"), ("brightness.levels", "2")]),
        settings(&[("replacement.entries", "256"), ("replacement.lanes", "32"), ("brightness.levels", "1")]),
    ]
}

// Claim: analysis: `compare` measures each changed work parameter with a run, and its shares sum to the whole change.
#[test]
fn work_parameters_are_measured_one_by_one_with_runs() {
    let bump = &MACHINES[0];
    let [before, after] = three_work_parameters();
    let (a, b) = (recorded_with(bump, &before), recorded_with(bump, &after));
    let explained = explain(bump, &a, &b, true).unwrap();
    assert_eq!(explained.shares.len(), 3, "{explained:?}");
    assert!(explained.shares.iter().all(|share| share.needs_run), "{explained:?}");
    check(bump, &before, &a.0, &b.0, &explained);
    let sum: f64 = explained.shares.iter().map(|share| share.share.unwrap()).sum();
    assert!((sum - (b.0.frame_cycles() as f64 - a.0.frame_cycles() as f64)).abs() < 0.01, "{explained:?}");
    assert_ne!(explained.together, 0, "entries and lanes interact");
    // By hand, in the order of the list: each share lies between the smallest and the largest effect over all orders.
    let lanes = explained.shares.iter().find(|share| share.parameter == "replacement.lanes").unwrap();
    assert!(lanes.by.unwrap() > 0 && lanes.share.unwrap() > 0.0, "fewer lanes take longer: {lanes:?}");
}

#[test]
fn work_parameters_without_runs_are_one_cause() {
    let bump = &MACHINES[0];
    let [before, after] = three_work_parameters();
    let (a, b) = (recorded_with(bump, &before), recorded_with(bump, &after));
    let explained = explain(bump, &a, &b, false).unwrap();
    assert_eq!((explained.shares.len(), explained.together), (1, 0), "{explained:?}");
    assert_eq!((explained.shares[0].parameter.as_str(), explained.shares[0].set.len()), ("work", 3));
}

/// The clock is work, because all cycles are relative to it; the cycles of a memory are derived from it.
#[test]
fn derived_values_belong_to_the_changed_parameter() {
    let hz = settings(&[("clock.hz", "100000000")]);
    let (a, b) = (recorded_with(&MACHINES[0], &vec![]), recorded_with(&MACHINES[0], &hz));
    let explained = explain(&MACHINES[0], &a, &b, false).unwrap();
    let [clock] = explained.shares.as_slice() else { panic!("{explained:?}") };
    assert_eq!((clock.parameter.as_str(), clock.set.as_slice()), ("clock.hz", &["clock.hz=100000000".to_owned()][..]));
    assert!(clock.derived.contains(&"memory.graphics.rcd".to_owned()), "{clock:?}");
}

#[test]
fn inseparable_changes_have_no_effect_without_runs() {
    // With fewer credits than a step needs, stamps have fewer fragments. Here no stamp is larger, but the simulator cannot know that.
    let changed = settings(&[("memory.normal_map.outstanding", "16"), ("fifo.shaded.depth", "2")]);
    let (a, b) = (recorded_with(&MACHINES[0], &vec![]), recorded_with(&MACHINES[0], &changed));
    let explained = explain(&MACHINES[0], &a, &b, false).unwrap();
    let apart: Vec<(&str, bool)> =
        explained.shares.iter().map(|share| (share.parameter.as_str(), share.cycles.is_none())).collect();
    assert_eq!(apart, [("fifo.shaded.depth", false), ("memory.normal_map.outstanding", true)], "{explained:?}");
    check(&MACHINES[0], &vec![], &a.0, &b.0, &explain(&MACHINES[0], &a, &b, true).unwrap());
}

#[test]
fn two_machines_have_no_common_causes() {
    let (a, b) = (recorded_with(&MACHINES[0], &vec![]), recorded_with(&MACHINES[1], &vec![]));
    assert_eq!(explain(&MACHINES[0], &a, &b, true), None);
}

#[test]
fn recording_of_another_run_is_rejected() {
    let (a, b) = (recorded_with(&MACHINES[0], &vec![]), recorded_with(&MACHINES[0], &changes(&MACHINES[0])[2].1));
    for (report, recording) in [(&a.0, &b.1), (&b.0, &a.1), (&recorded_with(&MACHINES[1], &vec![]).0, &a.1)] {
        let error = RecordedRun::read(report, &mut Cursor::new(recording), &MemoryPool::default()).err().unwrap();
        assert!(matches!(error, RecordingError::OtherRun), "{error}");
    }
}
