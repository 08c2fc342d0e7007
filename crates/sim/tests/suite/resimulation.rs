//! Independence of work from timing, on all machines: recordings, resimulation, bottlenecks, and explanations of differences.

use crate::common::{CollectedRecording, demo_scene};
use basrelief_input::MemoryPool;
use basrelief_parameters::{Effect, Parameter};
use basrelief_report::Report;
use basrelief_report::model::OutcomeKind;
use basrelief_scene::ViewOptions;
use basrelief_signals::Scene;
use basrelief_sim::{
    AnalysisPolicy, MACHINES, MachineConfig, MachineInfo, NoObserver, Observer, Overrides, Recording, RecordingError,
    ResimulateOptions, RunInput, RunOptions, display_list, input_sha256, resimulate, run, trace_header,
};
use basrelief_threads as threads;
use proptest::prelude::*;
use serde_json::Value;
use std::io::Cursor;
use std::sync::{Arc, LazyLock};

type Settings = Vec<(String, String)>;

/// Returns a small scene of the machine's first demo, or its trace.
fn scene(machine: &MachineInfo) -> Arc<Scene> {
    let options = ViewOptions { size: [40, 30], frames: Some(2), orbit_degrees: Some(20.0), ..ViewOptions::default() };
    demo_scene(machine.demos[0], &options)
}

fn of_scene(machine: &MachineInfo) -> RunInput {
    RunInput::scene(scene(machine))
}

fn of_trace(machine: &MachineInfo) -> RunInput {
    let scene = scene(machine);
    let mut recorder = basrelief_trace::TraceRecorder::new(Vec::new(), Default::default(), trace_header(&scene)).unwrap();
    display_list(&scene, &machine.load("", &[]).unwrap()).for_each(|control| recorder.record(&control).unwrap());
    RunInput::trace(Cursor::new(recorder.finish(Vec::new()).unwrap()), "recorded")
}

/// Returns report and recording of a run on one thread. On two threads, the run would be timed like a recording. Returns `None` if the
/// parameters do not fit together.
fn recorded(machine: &MachineInfo, source: RunInput, settings: &Settings, limits: AnalysisPolicy) -> Option<(Report, Vec<u8>)> {
    threads::sequential(|| recorded_here(machine, source, settings, limits))
}

fn recorded_here(
    machine: &MachineInfo,
    source: RunInput,
    settings: &Settings,
    limits: AnalysisPolicy,
) -> Option<(Report, Vec<u8>)> {
    let config = config(machine, settings)?;
    let given = Overrides { toml: String::new(), settings: settings.clone() };
    let settings = RunOptions {
        config,
        exact: false,
        bottlenecks: limits,
        overrides: given,
        recording: AnalysisPolicy::Always,
        ..RunOptions::default()
    };
    let mut taping = CollectedRecording::default();
    let run = run(source, &settings, &mut taping, None).ok()?;
    Some((run.report, taping.0)).filter(|_| run.recording_is_complete)
}

fn timed_again(recording: &[u8], settings: &Settings, limits: AnalysisPolicy) -> Result<Report, RecordingError> {
    let options = ResimulateOptions { settings: settings.clone(), bottlenecks: limits, ..ResimulateOptions::default() };
    resimulate(&mut Cursor::new(recording), &options)
}

/// Recordings of all machines, of scenes and of traces.
static RECORDINGS: LazyLock<Vec<(&MachineInfo, bool, Vec<u8>)>> = LazyLock::new(|| {
    let both = MACHINES.iter().flat_map(|machine| [(machine, false), (machine, true)]);
    both.map(|(machine, trace)| {
        (machine, trace, recorded(machine, source(machine, trace), &vec![], AnalysisPolicy::Never).unwrap().1)
    })
    .collect()
});

fn source(machine: &MachineInfo, trace: bool) -> RunInput {
    if trace { of_trace(machine) } else { of_scene(machine) }
}

/// Returns a value near the default of a parameter.
fn other(parameter: &Parameter, choice: u8) -> Option<String> {
    if parameter.key.ends_with(".part") {
        return Some(["sdr-100", "ddr-400", "sram", "ideal"][usize::from(choice) % 4].into());
    }
    match &parameter.default {
        Value::Number(n) => {
            let n = n.as_u64()?;
            Some([n / 2, n + 1, 2 * n + 3, n.saturating_sub(1), 1, 0][usize::from(choice) % 6].to_string())
        }
        Value::Bool(value) => Some((!value).to_string()),
        _ => None,
    }
}

fn some_settings(machine: &MachineInfo, choices: &[(prop::sample::Index, u8)]) -> Settings {
    let table: Vec<Parameter> = machine.parameters().into_iter().filter(|p| p.effect == Effect::Timing).collect();
    choices
        .iter()
        .filter_map(|(index, choice)| {
            let parameter = index.get(&table);
            Some((parameter.key.clone(), other(parameter, *choice)?))
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Law 6: under other timing parameters the work is bit-identical, and resimulation gives the report of a run, byte for byte. Parameters
    /// that change the work are rejected.
    #[test]
    fn resimulation_gives_the_report_of_a_run(which in 0..8_usize, choices in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
        let (machine, trace, recording) = &RECORDINGS[which];
        let settings = some_settings(machine, &choices);
        let Some((ran, other)) = recorded(machine, source(machine, *trace), &settings, AnalysisPolicy::Never) else { return Ok(()) };
        match timed_again(recording, &settings, AnalysisPolicy::Never) {
            Ok(again) => {
                prop_assert_eq!(again.to_json().unwrap(), ran.to_json().unwrap(), "{:?}", &settings);
                prop_assert_eq!(work(&other), work(recording), "{:?}", &settings);
            }
            Err(error) => prop_assert!(matches!(error, RecordingError::OtherWork(_)), "{}: {:?}", error, &settings),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Execution and timing on two threads give the same report, pictures and recording as one thread.
    #[test]
    fn two_threads_give_the_results_of_one(which in 0..8_usize, choices in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6)) {
        let (machine, trace, _) = &RECORDINGS[which];
        let settings = some_settings(machine, &choices);
        let bytes = |(report, recording): (Report, Vec<u8>)| (report.to_json().unwrap(), recording);
        let apart = recorded_here(machine, source(machine, *trace), &settings, AnalysisPolicy::Never).map(bytes);
        let alone = recorded(machine, source(machine, *trace), &settings, AnalysisPolicy::Never).map(bytes);
        prop_assert_eq!(apart, alone, "{:?}", &settings);
    }
}

/// A fault occurs in the same cycle, although execution runs ahead of timing.
#[test]
fn faults_are_the_same_on_two_threads() {
    let settings = [("replacement.codebook", "per_object"), ("replacement.gather_bytes", "4096")];
    let config = MACHINES[0].load("", &settings).unwrap();
    let fault = || {
        let options = RunOptions { config: config.clone(), exact: false, ..RunOptions::default() };
        let ran = run(of_scene(&MACHINES[0]), &options, &mut CollectedRecording::default(), None);
        ran.map(|run| run.report.outcome).unwrap_err().to_string()
    };
    let alone = threads::sequential(fault);
    assert!(alone.starts_with("replacement, cycle ") && alone.contains("`replacement.gather_bytes` is 4096"), "{alone}");
    assert_eq!(fault(), alone);
}

/// Observer that stops the run at once.
struct Stopping;

impl Observer for Stopping {
    fn progress(&mut self, _: u64, _: Option<u64>) -> bool {
        false
    }
}

#[test]
fn stopped_run_has_a_partial_report() {
    for machine in MACHINES {
        let options = RunOptions { config: machine.load("", &[]).unwrap(), exact: false, ..RunOptions::default() };
        let stopped = |source| run(source, &options, &mut Stopping, None).unwrap().report.outcome.kind;
        let kinds = [threads::sequential(|| stopped(of_scene(machine))), stopped(of_scene(machine))];
        assert_eq!(kinds, [OutcomeKind::Stopped; 2], "{}", machine.name);
    }
}

/// Loads the configuration of a machine; `None` if the settings do not fit together.
fn config(machine: &MachineInfo, settings: &Settings) -> Option<MachineConfig> {
    let borrowed: Vec<(&str, &str)> = settings.iter().map(|(k, v)| (k.as_str(), v.as_str())).collect();
    machine.load("", &borrowed).ok().filter(|config| config.check().is_ok())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Two resimulations of a recording in memory.
    #[test]
    fn recording_in_memory_can_be_resimulated_repeatedly(which in 0..8_usize, choices in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4)) {
        let (machine, trace, recording) = &RECORDINGS[which];
        let recording = Recording::read(&mut Cursor::new(recording), &MemoryPool::default()).unwrap();
        for settings in [some_settings(machine, &choices), vec![]] {
            let Some(config) = config(machine, &settings) else { return Ok(()) };
            let Some((ran, _)) = recorded(machine, source(machine, *trace), &settings, AnalysisPolicy::Never) else { return Ok(()) };
            match recording.resimulate(&config) {
                Ok(again) => prop_assert_eq!(again.to_json().unwrap(), ran.to_json().unwrap(), "{:?}", &settings),
                Err(error) => prop_assert!(matches!(error, RecordingError::OtherWork(_)), "{}: {:?}", error, &settings),
            }
        }
    }
}

#[test]
fn recording_rejects_other_work() {
    let (machine, _, recording) = &RECORDINGS[0];
    let recording = Recording::read(&mut Cursor::new(recording), &MemoryPool::default()).unwrap();
    let error = |machine: &MachineInfo, settings: &[(&str, &str)]| {
        let settings = settings.iter().map(|(key, value)| ((*key).into(), (*value).into())).collect();
        recording.resimulate(&config(machine, &settings).unwrap()).unwrap_err().to_string()
    };
    let work = error(machine, &[("replacement.entries", "64")]);
    assert!(work.contains("`replacement.entries` changes the work of the units"), "{work}");
    assert!(error(&MACHINES[1], &[]).contains("it was recorded on machine `bump`"));
}

#[test]
fn input_hash_matches_the_report() {
    for (machine, trace, _) in RECORDINGS.iter() {
        let config = machine.load("", &[]).unwrap();
        let (report, _) = recorded(machine, source(machine, *trace), &vec![], AnalysisPolicy::Never).unwrap();
        assert_eq!(input_sha256(source(machine, *trace), &config, &MemoryPool::default()).unwrap(), report.input.sha256);
    }
}

/// Returns the SHA-256 of the work that a recording states.
fn work(recording: &[u8]) -> String {
    let text = String::from_utf8_lossy(&recording[recording.len() - 120..]).into_owned();
    let stated = text.split_once("\"work\":\"").unwrap().1;
    stated.split_once('"').unwrap().0.to_owned()
}

#[test]
fn bottleneck_settings_take_the_predicted_cycles() {
    for (machine, trace) in MACHINES.iter().flat_map(|machine| [(machine, false), (machine, true)]) {
        let (report, _) = recorded(machine, source(machine, trace), &vec![], AnalysisPolicy::Always).unwrap();
        let limits = report.bottlenecks.clone().unwrap().single;
        assert!(!limits.is_empty(), "{}: something limits it", machine.name);
        assert!(limits.is_sorted_by_key(|limit| limit.cycles));
        let path = report.critical_path.as_ref().unwrap();
        for limit in limits {
            // A unit saves at most its part of the path, plus all memory segments of the path.
            let kinds = ["occupancy", "latency", "FIFO", "slot", "rest"];
            let parts = path.parts.iter().filter(|part| part.resource == limit.resource || !kinds.contains(&part.what.as_str()));
            let spent: u64 = parts.map(|part| part.cycles).sum();
            let is_unit = limit.set[0].starts_with("ideal.units") && !limit.resource.contains(" and ");
            assert!(!is_unit || limit.saved <= spent, "{}: {} saves more than its part", machine.name, limit.resource);
            assert_eq!(limit.saved, report.frame_cycles() - limit.cycles);
            let set: Settings =
                limit.set.iter().map(|set| set.split_once('=').map(|(k, v)| (k.into(), v.into())).unwrap()).collect();
            let given = Overrides { toml: String::new(), settings: set.clone() };
            given.load_checked(machine, &MemoryPool::default()).expect("a user can give it, too");
            let (promised, _) = recorded(machine, source(machine, trace), &set, AnalysisPolicy::Never).unwrap();
            assert_eq!(promised.frame_cycles(), limit.cycles, "{}: {} with {}", machine.name, limit.resource, limit.what);
            assert_eq!(promised.image, report.image, "{}: the picture stays", machine.name);
        }
    }
}

#[test]
fn ideal_unit_of_another_input_is_a_warning() {
    let machine = &MACHINES[0];
    let set = vec![("ideal.units".to_owned(), "display-list".to_owned())];
    let warned = |trace| {
        let (report, _) = recorded(machine, source(machine, trace), &set, AnalysisPolicy::Never).unwrap();
        report.warnings.iter().any(|warning| warning.starts_with("ideal.units names `display-list`"))
    };
    assert_eq!([false, true].map(warned), [true, false]);
}

#[test]
fn late_write_of_a_frame_end_loses_no_frame() {
    let late = vec![("frame_buffer.latency".to_owned(), "4096".to_owned())];
    for machine in MACHINES.iter().filter(|machine| !machine.fetches_tiles) {
        let cycles = |set| recorded(machine, of_scene(machine), set, AnalysisPolicy::Always).unwrap().0.cycles.unwrap();
        let [soon, late] = [&vec![], &late].map(cycles);
        assert_eq!([soon.frames.len(), late.frames.len()], [2, 2], "{}", machine.name);
        let [soon, late] = [soon, late].map(|cycles| cycles.frames.iter().sum::<u64>());
        assert!(late >= soon + 4000, "{}: {late} after {soon}", machine.name);
    }
}

#[test]
fn step_beyond_32_bits_has_no_recording_and_a_warning() {
    let machine = MACHINES.iter().find(|machine| machine.fetches_tiles).unwrap();
    let slow = vec![("path.bits_per_second".to_owned(), "100".to_owned())];
    let options = RunOptions {
        config: config(machine, &slow).unwrap(),
        exact: false,
        bottlenecks: AnalysisPolicy::Always,
        recording: AnalysisPolicy::Always,
        ..RunOptions::default()
    };
    for concurrent in [true, false] {
        let run = || run(of_scene(machine), &options, &mut CollectedRecording::default(), None).unwrap();
        let result = if concurrent { run() } else { threads::sequential(run) };
        assert!(!result.recording_is_complete && result.report.bottlenecks.is_none());
        assert!(result.report.outcome.is_complete());
        let warnings = &result.report.warnings;
        assert!(warnings.iter().any(|text| text.contains("a step takes more than 4294967295 cycles")), "{warnings:?}");
    }
}

#[test]
fn critical_path_is_as_long_as_the_frames() {
    for machine in MACHINES {
        let late = vec![("frame_buffer.latency".to_owned(), "64".to_owned())];
        let set = if machine.fetches_tiles { vec![] } else { late };
        let (report, _) = recorded(machine, of_scene(machine), &set, AnalysisPolicy::Always).unwrap();
        let path = report.critical_path.as_ref().unwrap();
        assert_eq!(path.cycles, report.frame_cycles(), "{}", machine.name);
        assert_eq!(path.parts.iter().map(|part| part.cycles).sum::<u64>(), path.cycles, "{}", machine.name);
        let frames = report.cycles.as_ref().unwrap().frames.iter().enumerate();
        for (frame, cycles) in frames {
            assert_eq!(path.parts.iter().map(|part| part.frames[frame]).sum::<u64>(), *cycles, "{} {frame}", machine.name);
        }
    }
}

#[test]
fn kept_steps_count_against_the_memory_limit() {
    let machine = &MACHINES[0];
    let (_, recording) = recorded(machine, of_scene(machine), &vec![], AnalysisPolicy::Never).unwrap();
    // A block and its decoded steps are in memory at the same time. Bottleneck analysis keeps the steps as well.
    let options = |limits| ResimulateOptions {
        bottlenecks: limits,
        budget: MemoryPool::new(recording.len() as u64 * 22 / 10),
        ..ResimulateOptions::default()
    };
    resimulate(&mut Cursor::new(&recording), &options(AnalysisPolicy::Never)).unwrap();
    let error = resimulate(&mut Cursor::new(&recording), &options(AnalysisPolicy::Always)).unwrap_err();
    assert!(matches!(error, RecordingError::OverBudget(_)), "{error}");
    let without = resimulate(&mut Cursor::new(&recording), &options(AnalysisPolicy::IfShort)).unwrap();
    assert!(without.bottlenecks.is_none());
}

#[test]
fn analysis_that_nobody_asked_for_ends_no_run() {
    let machine = &MACHINES[0];
    let run_with = |bottlenecks, bytes| {
        let options = RunOptions { bottlenecks, budget: MemoryPool::new(bytes), exact: false, ..RunOptions::default() };
        run(of_scene(machine), &options, &mut NoObserver, None).map(|run| run.report)
    };
    // The least budget of a run leaves no room for its steps.
    let least = (0..).map(|k| (8 << 10) * k).find(|&bytes| run_with(AnalysisPolicy::Never, bytes).is_ok()).unwrap();
    assert!(run_with(AnalysisPolicy::Always, least).is_err());
    let report = run_with(AnalysisPolicy::IfShort, least).unwrap();
    assert!(report.bottlenecks.is_none());
    assert!(report.warnings.iter().any(|warning| warning.contains("--memory-limit")), "{:?}", report.warnings);
}

#[test]
fn bottlenecks_of_recording_and_run_are_equal() {
    for machine in MACHINES {
        let (report, recording) = recorded(machine, of_scene(machine), &vec![], AnalysisPolicy::Always).unwrap();
        assert_eq!(timed_again(&recording, &vec![], AnalysisPolicy::Always).unwrap(), report);
    }
}

#[test]
fn invalid_resimulations_are_rejected() {
    let (_, _, recording) = &RECORDINGS[0];
    let error = |settings: &[(&str, &str)], recording: &[u8]| {
        let settings = settings.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect();
        timed_again(recording, &settings, AnalysisPolicy::Never).unwrap_err().to_string()
    };
    assert!(error(&[("replacement.lanes", "8")], recording).contains("`replacement.lanes` changes the work of the units"));
    assert!(error(&[("cache.clut.line_bytes", "32")], recording).contains("changes the work of the units"));
    // With fewer credits than a step needs, stamps have fewer fragments, which changes the work.
    assert!(error(&[("memory.normal_map.outstanding", "16")], recording).contains("other work"));
    assert!(error(&[("fifo.shadde.depth", "8")], recording).contains("unknown parameter"));
    assert!(error(&[], b"something else altogether").contains("not a recording"));
    assert!(error(&[], &recording[..recording.len() / 2]).contains("truncated"));
    assert!(error(&[], &recording[..recording.len() - 9]).contains("truncated"));
    let mut spoiled = recording.clone();
    let middle = spoiled.len() / 2;
    spoiled[middle] ^= 1;
    // The changed byte is a different or an invalid step; either way, the recorded work has changed.
    assert!(timed_again(&spoiled, &vec![], AnalysisPolicy::Never).is_err());
}
