//! Sensitivity: every assumed parameter, each equal to a run with that value, for any number of threads.

use crate::support::{Program, plan, sweep};
use basrelief_dse::{OneAtATimeBase, OpenedInput, Plan, sensitivity};
use basrelief_input::MemoryPool;
use basrelief_report::sensitivity::{ComesTo, Measure, MeasureChange, ParameterChange, Sensitivity};
use basrelief_scene::{ViewOptions, demo};
use basrelief_sim::{MACHINES, MachineInfo, NoObserver, Overrides, PreparedScene, RunInput, RunOptions, run};
use std::collections::BTreeSet;
use std::fs;
use std::sync::Arc;
use tempfile::tempdir;

/// The first demo of a machine, small.
fn around(machine: &'static MachineInfo, given: Overrides, frames: u32) -> OneAtATimeBase {
    let options = ViewOptions { size: [32, 24], frames: Some(frames), ..ViewOptions::default() };
    let scene = Arc::new(demo(machine.demos[0], &options).unwrap());
    let opened = OpenedInput::Scene(PreparedScene::cached(scene, &MemoryPool::default()));
    OneAtATimeBase { name: machine.demos[0].into(), opened, machine, given, max_cycles: u64::MAX, exact: true }
}

fn measured(around: &OneAtATimeBase, threads: usize) -> Sensitivity {
    let host = Program::new();
    sensitivity(&Plan::one_at_a_time(around.clone(), &host).unwrap(), threads, &host).unwrap()
}

/// Measures of a run with one more setting.
fn measured_alone(around: &OneAtATimeBase, set: Option<(&str, String)>) -> Measure {
    let OpenedInput::Scene(prepared) = &around.opened else { panic!("a scene") };
    let settings = around.given.settings.iter().cloned().chain(set.map(|(key, value)| (key.to_owned(), value))).collect();
    let given = Overrides { settings, ..around.given.clone() };
    let config = given.config(around.machine, &[]).unwrap();
    let options = RunOptions { config, overrides: given, ..RunOptions::default() };
    run(RunInput::Scene(prepared.clone()), &options, &mut NoObserver, None).unwrap().report.measure()
}

fn set(change: &ParameterChange) -> Option<(&str, String)> {
    Some((&change.parameter, change.to.as_str().map_or_else(|| change.to.to_string(), str::to_owned)))
}

/// The largest change in percent.
fn size(change: &ParameterChange) -> f64 {
    let ComesTo::Run(moved) = &change.comes_to else { return -1.0 };
    let decibels = 12.2 * moved.psnr_change_db.unwrap();
    let changes = [moved.cycles_percent, moved.time_percent, moved.bytes_percent, moved.area_percent, decibels];
    changes.into_iter().fold(0.0, |most: f64, change| most.max(change.abs()))
}

/// All that is said of one machine.
fn every_assumption_is_changed(machine: usize, frames: u32) {
    let machine = &MACHINES[machine];
    let around = around(machine, Overrides::default(), frames);
    let told = measured(&around, 2);
    assert_eq!(told.base, measured_alone(&around, None));

    let config = machine.load("", &[]).unwrap();
    let varied = config.described().into_iter().filter(|p| p.provenance.kind == "assumed" || p.key.starts_with("area."));
    let wanted: BTreeSet<String> = varied.map(|p| p.key).collect();
    let changed: BTreeSet<String> = told.changes.iter().map(|change| change.parameter.clone()).collect();
    let unchanged: BTreeSet<String> = told.unchanged.iter().cloned().collect();
    assert_eq!(changed.union(&unchanged).cloned().collect::<BTreeSet<_>>(), wanted);
    assert!(unchanged.iter().all(|key| key == "ideal.units" || key.starts_with("defer.")), "{unchanged:?}");

    assert!(told.changes.windows(2).all(|pair| size(&pair[0]) >= size(&pair[1])), "the largest first");
    // The largest changes, and some of each kind.
    let runs = told.changes.iter().filter_map(|change| match &change.comes_to {
        ComesTo::Run(moved) => Some((change, moved)),
        ComesTo::Nothing { .. } => None,
    });
    for (change, moved) in runs.clone().filter(|(change, _)| change.parameter.starts_with("area.")) {
        assert_eq!((moved.cycles_percent, moved.time_percent, moved.bytes_percent), (0.0, 0.0, 0.0), "{change:?}");
        assert_eq!(moved.psnr_change_db, Some(0.0), "{change:?}");
    }
    let memory_bit = |(change, moved): &(&ParameterChange, &MeasureChange)| {
        change.parameter == "area.memory_bit" && moved.area_percent.abs() > 5.0
    };
    assert_eq!(runs.clone().filter(memory_bit).count(), 2, "a coefficient changes the area");
    let clock = |(change, moved): &(&ParameterChange, &MeasureChange)| {
        change.parameter == "clock.hz" && (moved.time_percent - moved.cycles_percent).abs() > 1.0
    };
    assert_eq!(runs.clone().filter(clock).count(), 2, "the clock changes the length of a cycle");
    for (change, moved) in runs.clone().take(3).chain(runs.step_by(23)) {
        assert_eq!(moved.measure, measured_alone(&around, set(change)), "{change:?}");
    }
    for change in told.changes.iter().filter(|change| size(change) < 0.0) {
        let ComesTo::Nothing { reason } = &change.comes_to else { panic!("{change:?}") };
        let config = around.given.config(machine, &[set(change).map(|(key, value)| (key.to_owned(), value)).unwrap()]);
        let refused =
            config.map_or_else(|e| e.to_string(), |config| config.check().map_or_else(|e| e.to_string(), |()| String::new()));
        println!("{} {}: {reason}", change.parameter, change.to);
        assert!(reason.split_once(": ").is_some_and(|(word, why)| word != "unfit" || why == refused), "{reason}");
    }
}

// Claim: analysis: The sensitivity analysis changes every assumed parameter and every coefficient of the area. A row equals a run with its value, on any number of
// threads.
#[test]
fn bump_sensitivity_equals_separate_runs() {
    every_assumption_is_changed(0, 1);
}

// Claim: as bump_sensitivity_equals_separate_runs.
#[test]
fn shade_sensitivity_equals_separate_runs() {
    every_assumption_is_changed(1, 1);
}

// Claim: as bump_sensitivity_equals_separate_runs.
#[test]
fn texel_sensitivity_equals_separate_runs() {
    every_assumption_is_changed(2, 2);
}

// Claim: as bump_sensitivity_equals_separate_runs.
#[test]
fn defer_sensitivity_equals_separate_runs() {
    every_assumption_is_changed(3, 1);
}

// Claim: as bump_sensitivity_equals_separate_runs.
#[test]
fn sensitivity_does_not_depend_on_threads() {
    let settings = vec![("shade.mode".to_owned(), "normal".to_owned()), ("cpu.divide".to_owned(), "40".to_owned())];
    let around = around(&MACHINES[1], Overrides { toml: "[cpu]\nmultiply = 9".into(), settings }, 1);
    let [one, two] = [1, 2].map(|threads| measured(&around, threads));
    assert_eq!(serde_json::to_string(&one).unwrap(), serde_json::to_string(&two).unwrap());
    let values = |key: &str| {
        let of = one.changes.iter().filter(|change| change.parameter == key);
        of.map(|change| (change.from.as_u64().unwrap(), change.to.as_u64().unwrap())).collect::<BTreeSet<_>>()
    };
    assert_eq!(values("cpu.divide"), BTreeSet::from([(40, 20), (40, 60)]));
    assert_eq!(values("cpu.multiply"), BTreeSet::from([(9, 5), (9, 14)]));
    let change = one.changes.iter().find(|change| change.parameter == "cpu.divide").unwrap();
    let ComesTo::Run(moved) = &change.comes_to else { panic!("{change:?}") };
    assert_eq!(moved.measure, measured_alone(&around, set(change)));
}

#[test]
fn cycle_limit_is_a_row_and_no_pictures_no_psnr() {
    let around = around(&MACHINES[1], Overrides::default(), 1);
    let total = {
        let OpenedInput::Scene(prepared) = &around.opened else { panic!("a scene") };
        run(
            RunInput::Scene(prepared.clone()),
            &RunOptions { config: MACHINES[1].load("", &[]).unwrap(), ..RunOptions::default() },
            &mut NoObserver,
            None,
        )
        .unwrap()
        .report
        .cycles
        .unwrap()
        .total
    };
    let told = measured(&OneAtATimeBase { max_cycles: total, exact: false, ..around.clone() }, 2);
    assert_eq!(told.base.psnr_db, None);
    let limit = ComesTo::Nothing { reason: "limit: stopped at the limit of max_cycles".into() };
    let (beyond, within): (Vec<_>, Vec<_>) = told.changes.iter().partition(|change| change.comes_to == limit);
    assert!(!beyond.is_empty() && within.len() > beyond.len());
    let short = OneAtATimeBase { max_cycles: total / 2, ..around };
    let host = Program::new();
    let error = sensitivity(&Plan::one_at_a_time(short, &host).unwrap(), 2, &host).unwrap_err().to_string();
    assert_eq!(error, "as configured: limit: stopped at the limit of max_cycles");
}

/// Two axes of their own, and the base beside them.
const PLAN: &str = "input = \"demo:ellipsoid@1\"\nmachine = \"shade\"\nobjectives = [\"cycles min\"]\n\
                    samples = { method = \"one_at_a_time\" }\nconfig.cpu.divide = 40\n\
                    [axes]\nshade.mode = [\"normal\", \"brightness\"]\nfifo.interpolated.depth = [1, 2, 64]\n\
                    [[zip]]\ncpu.divide = [10, 20]\ncpu.multiply = [2, 3]\n";

#[test]
fn one_at_a_time_plan_varies_one_axis() {
    let folder = tempdir().unwrap();
    let (plan, tally) = sweep(PLAN, folder.path(), 2);
    // The depth that is the default's is the base.
    let depth = plan.machine.parameters().into_iter().find(|p| p.key == "fifo.interpolated.depth").unwrap().default;
    let depths = [1, 2, 64].into_iter().filter(|given| depth != *given).count();
    let mode = plan.machine.parameters().into_iter().find(|p| p.key == "shade.mode").unwrap().default;
    let modes = ["normal", "brightness"].into_iter().filter(|given| mode != *given).count();
    assert_eq!((tally.points, tally.failed), (1 + depths + modes + 2, 0));
    let table = fs::read_to_string(folder.path().join("sweep.csv")).unwrap();
    let mut lines = table.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').take(8).collect();
    assert_eq!(head[4..], ["shade.mode", "fifo.interpolated.depth [tokens]", "cpu.divide [cycles]", "cpu.multiply [cycles]"]);
    let axes: Vec<String> = lines.map(|line| line.split(',').skip(4).take(4).collect::<Vec<_>>().join(" ")).collect();
    let mode = mode.as_str().unwrap();
    assert_eq!(axes[0], format!("{mode} {depth} 40 4"));
    assert_eq!(axes[axes.len() - 2..], [format!("{mode} {depth} 10 2"), format!("{mode} {depth} 20 3")]);
}

#[test]
fn a_plan_without_axes_changes_every_assumption() {
    let host = Program::new();
    let text = "input = \"demo:ellipsoid@1\"\nmachine = \"shade\"\nobjectives = [\"cycles min\"]\nsamples = { method = \"one_at_a_time\" }\n";
    let of_file = plan(text, &host);
    let OpenedInput::Scene(prepared) = &of_file.inputs[0].opened else { panic!("a scene") };
    let around = OneAtATimeBase { opened: OpenedInput::Scene(prepared.clone()), ..around(&MACHINES[1], Overrides::default(), 1) };
    let of_run = Plan::one_at_a_time(around, &host).unwrap();
    assert_eq!(of_run.points.iter().map(|p| &p.id).collect::<Vec<_>>(), of_file.points.iter().map(|p| &p.id).collect::<Vec<_>>());
    let error = Plan::read(&text.replace("time\" }", "time\", points = 4 }"), &host).unwrap_err().to_string();
    assert!(error.contains("has all its points; leave `points` out"), "{error}");
}
