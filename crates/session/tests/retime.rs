//! Work does not depend on time, on all machines: what a tape holds, what is timed again from it, and what is said to limit a run.

use basrelief_input::Budget;
use basrelief_parameters::{Effect, Parameter};
use basrelief_report::Report;
use basrelief_scene::{ViewOptions, demo};
use basrelief_session::{
    Given, Limits, MACHINES, MachineInfo, Observer, RetimeOptions, RunInput, RunOptions, TapeFileError, begin_of, display_list,
    retime, run,
};
use basrelief_signals::Scene;
use proptest::prelude::*;
use serde_json::Value;
use std::io::Cursor;
use std::sync::{Arc, LazyLock};

/// Takes the tape.
#[derive(Default)]
struct Taping(Vec<u8>);

impl Observer for Taping {
    fn tape(&mut self, bytes: &[u8]) -> Result<(), String> {
        self.0.extend_from_slice(bytes);
        Ok(())
    }
}

type Settings = Vec<(String, String)>;

/// A scene of each machine's first demo, small; and its display list.
fn scene(machine: &MachineInfo) -> Arc<Scene> {
    let options = ViewOptions { size: [40, 30], frames: Some(2), orbit_degrees: Some(20.0), ..ViewOptions::default() };
    Arc::new(demo(machine.demos[0], &options).unwrap())
}

fn of_scene(machine: &MachineInfo) -> RunInput {
    RunInput::Scene(scene(machine))
}

fn of_trace(machine: &MachineInfo) -> RunInput {
    let scene = scene(machine);
    let mut recorder = basrelief_display_list::Recorder::new(Vec::new(), Default::default(), begin_of(&scene)).unwrap();
    display_list(&scene, &machine.load("", &[]).unwrap()).for_each(|control| recorder.record(&control).unwrap());
    RunInput::trace(Cursor::new(recorder.finish(Vec::new()).unwrap()), "recorded")
}

/// Report and tape of a run; none where the parameters do not fit.
fn recorded(machine: &MachineInfo, source: RunInput, settings: &Settings, limits: Limits) -> Option<(Report, Vec<u8>)> {
    let borrowed: Vec<(&str, &str)> = settings.iter().map(|(k, v)| (k.as_str(), v.as_str())).collect();
    let config = machine.load("", &borrowed).ok().filter(|config| config.check().is_ok())?;
    let given = Given { toml: String::new(), settings: settings.clone() };
    let settings = RunOptions { config, exact: false, limits, given, tape: true, ..RunOptions::default() };
    let mut taping = Taping::default();
    let run = run(source, &settings, &mut taping, None).ok()?;
    Some((run.report, taping.0)).filter(|_| run.tape_is_whole)
}

fn timed_again(tape: &[u8], settings: &Settings, limits: Limits) -> Result<Report, TapeFileError> {
    let options = RetimeOptions { settings: settings.clone(), limits, budget: Budget::default() };
    retime(&mut Cursor::new(tape), &options)
}

/// The tapes of all machines, behind both ways in.
static TAPES: LazyLock<Vec<(&MachineInfo, bool, Vec<u8>)>> = LazyLock::new(|| {
    let both = MACHINES.iter().flat_map(|machine| [(machine, false), (machine, true)]);
    both.map(|(machine, trace)| (machine, trace, recorded(machine, source(machine, trace), &vec![], Limits::Never).unwrap().1))
        .collect()
});

fn source(machine: &MachineInfo, trace: bool) -> RunInput {
    if trace { of_trace(machine) } else { of_scene(machine) }
}

/// A value near the default of a parameter.
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

    /// Law 6 of every unit: under other times the work is the same to the bit, and timing it again gives the report of a run, byte
    /// for byte. Where the parameters change the work, it is said.
    #[test]
    fn timing_a_tape_again_gives_the_report_of_a_run(which in 0..8_usize, choices in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
        let (machine, trace, tape) = &TAPES[which];
        let settings = some_settings(machine, &choices);
        let Some((ran, other)) = recorded(machine, source(machine, *trace), &settings, Limits::Never) else { return Ok(()) };
        match timed_again(tape, &settings, Limits::Never) {
            Ok(again) => {
                prop_assert_eq!(again.to_json().unwrap(), ran.to_json().unwrap(), "{:?}", &settings);
                prop_assert_eq!(work(&other), work(tape), "{:?}", &settings);
            }
            Err(error) => prop_assert!(matches!(error, TapeFileError::OtherWork(_)), "{}: {:?}", error, &settings),
        }
    }
}

/// The SHA-256 that a tape states of its work.
fn work(tape: &[u8]) -> String {
    let text = String::from_utf8_lossy(&tape[tape.len() - 80..]).into_owned();
    text[text.find("\"work\":").unwrap()..].to_owned()
}

#[test]
fn a_run_with_what_limits_say_takes_the_cycles_they_say() {
    for machine in MACHINES {
        let (report, _) = recorded(machine, of_scene(machine), &vec![], Limits::Always).unwrap();
        let limits = report.limits.clone().unwrap();
        assert!(!limits.is_empty(), "{}: something limits it", machine.name);
        assert!(limits.is_sorted_by_key(|limit| limit.cycles));
        let path = report.critical_path.as_ref().unwrap();
        for limit in limits {
            // No more than the path is shorter without it; with it, all that memories do on the path may be.
            let kinds = ["occupancy", "latency", "FIFO", "slot", "rest"];
            let parts = path.parts.iter().filter(|part| part.resource == limit.resource || !kinds.contains(&part.what.as_str()));
            let spent: u64 = parts.map(|part| part.cycles).sum();
            let is_unit = limit.set[0].starts_with("ideal.units") && !limit.resource.contains(" and ");
            assert!(!is_unit || limit.saved <= spent, "{}: {} saves more than its part", machine.name, limit.resource);
            assert_eq!(limit.saved, report.frame_cycles() - limit.cycles);
            let set = limit.set.iter().map(|set| set.split_once('=').map(|(k, v)| (k.into(), v.into())).unwrap()).collect();
            let (promised, _) = recorded(machine, of_scene(machine), &set, Limits::Never).unwrap();
            assert_eq!(promised.frame_cycles(), limit.cycles, "{}: {} with {}", machine.name, limit.resource, limit.what);
            assert_eq!(promised.image, report.image, "{}: the picture stays", machine.name);
        }
    }
}

#[test]
fn a_critical_path_is_as_long_as_the_frames() {
    for machine in MACHINES {
        let (report, _) = recorded(machine, of_scene(machine), &vec![], Limits::Always).unwrap();
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
fn limits_of_a_tape_are_those_of_the_run() {
    for machine in MACHINES {
        let (report, tape) = recorded(machine, of_scene(machine), &vec![], Limits::Always).unwrap();
        assert_eq!(timed_again(&tape, &vec![], Limits::Always).unwrap(), report);
    }
}

#[test]
fn what_cannot_be_timed_again_is_said() {
    let (_, _, tape) = &TAPES[0];
    let error = |settings: &[(&str, &str)], tape: &[u8]| {
        let settings = settings.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect();
        timed_again(tape, &settings, Limits::Never).unwrap_err().to_string()
    };
    assert!(error(&[("replacement.lanes", "8")], tape).contains("`replacement.lanes` changes what the units do"));
    assert!(error(&[("cache.clut.line_bytes", "32")], tape).contains("changes what the units do"));
    // Fewer credits than a step needs: stamps of fewer fragments, which is work.
    assert!(error(&[("memory.normal_map.outstanding", "16")], tape).contains("other work"));
    assert!(error(&[("fifo.shadde.depth", "8")], tape).contains("unknown parameter"));
    assert!(error(&[], b"something else altogether").contains("not a tape"));
    assert!(error(&[], &tape[..tape.len() / 2]).contains("ends"));
    assert!(error(&[], &tape[..tape.len() - 9]).contains("ends"));
    let mut spoiled = tape.clone();
    let middle = spoiled.len() / 2;
    spoiled[middle] ^= 1;
    // A step that does something else, or one that no step does: either way it is no longer the work that was recorded.
    assert!(timed_again(&spoiled, &vec![], Limits::Never).is_err());
}
