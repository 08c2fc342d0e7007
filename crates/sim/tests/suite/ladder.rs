//! Bottleneck ladder: every rung takes the cycles that it promises, and a group of saturated units is found.

use crate::common::demo_scene;
use basrelief_report::Report;
use basrelief_report::model::{Bottlenecks, IDEAL_MEMORY, NO_DISPLAY, RelaxedSet};
use basrelief_scene::ViewOptions;
use basrelief_sim::{AnalysisPolicy, MACHINES, MachineInfo, NoObserver, Overrides, RunInput, RunOptions, run};
use serde_json::Value;

type Settings = Vec<(String, String)>;

/// Runs a frame of a demo with these settings.
fn ran(machine: &MachineInfo, demo_name: &str, size: [u32; 2], settings: &Settings, bottlenecks: AnalysisPolicy) -> Report {
    let options = ViewOptions { size, frames: Some(1), ..ViewOptions::default() };
    ran_views(machine, demo_name, &options, settings, bottlenecks)
}

/// Runs a demo with these views and settings.
fn ran_views(
    machine: &MachineInfo,
    demo_name: &str,
    options: &ViewOptions,
    settings: &Settings,
    bottlenecks: AnalysisPolicy,
) -> Report {
    let overrides = Overrides { toml: String::new(), settings: settings.clone() };
    let config = overrides.config(machine, &[]).unwrap();
    let options_of_run = RunOptions { config, exact: false, bottlenecks, overrides, ..RunOptions::default() };
    run(RunInput::scene(demo_scene(demo_name, options)), &options_of_run, &mut NoObserver, None).unwrap().report
}

fn settings(set: &[String]) -> Settings {
    set.iter().map(|set| set.split_once('=').map(|(key, value)| (key.into(), value.into())).unwrap()).collect()
}

fn bottlenecks(report: &Report) -> &Bottlenecks {
    report.bottlenecks.as_ref().unwrap()
}

// Claim: analysis: A full run with the options of each rung of the ladder takes the cycles of that rung.
#[test]
fn rung_options_take_the_predicted_cycles() {
    for machine in MACHINES {
        let whole = ran(machine, machine.demos[0], [40, 30], &vec![], AnalysisPolicy::Always);
        let of = bottlenecks(&whole);
        assert!(!of.ladder.is_empty(), "{}", machine.name);
        let mut before: &[String] = &[];
        for rung in of.ladder.iter().chain(&of.balanced) {
            let again = ran(machine, machine.demos[0], [40, 30], &settings(&rung.set), AnalysisPolicy::Never);
            assert_eq!(again.frame_cycles(), rung.cycles, "{}: {:?}", machine.name, rung.set);
            assert_eq!(again.image, whole.image, "{}: the picture stays", machine.name);
            let share = 1.0 - rung.cycles as f64 / whole.frame_cycles() as f64;
            assert!((rung.saved - share).abs() < 1e-6, "{}: {rung:?}", machine.name);
        }
        for rung in &of.ladder {
            assert!(rung.relaxed.len() > before.len() && rung.relaxed.starts_with(before), "{}: {rung:?}", machine.name);
            before = &rung.relaxed;
        }
        let least = of.ladder.iter().map(|rung| rung.cycles).min();
        assert_eq!(of.ladder.last().map(|rung| rung.cycles), least, "{}: the last rung saves most", machine.name);
        let single = of.single.iter().map(|limit| limit.cycles).min();
        assert!(least <= single, "{}: the ladder saves at least as much as one relaxation", machine.name);
    }
}

// Claim: analysis: A display whose refresh the frames wait for is the bottleneck.
#[test]
fn display_that_frames_wait_for_is_the_bottleneck() {
    for (machine, set) in [("defer", "defer.depth_pixel=shared"), ("bump", "display.mode=fifo"), ("texel", "display.mode=fifo")] {
        let machine = MachineInfo::named(machine).unwrap();
        let frames = ViewOptions { size: [40, 30], frames: Some(3), ..ViewOptions::default() };
        let run = |set: &[String], policy| ran_views(machine, "coin", &frames, &settings(set), policy);
        let whole = run(&[set.into()], AnalysisPolicy::Always);
        let of = bottlenecks(&whole);
        let (best, last) = (of.single.first().unwrap(), of.ladder.last().unwrap());
        assert_eq!((best.resource.as_str(), best.what.as_str()), ("display", NO_DISPLAY), "{set}");
        assert!(2 * best.saved > whole.frame_cycles(), "{set}: {best:?}");
        assert!(of.ladder[0].relaxed.contains(&"display".into()), "{set}: {:?}", of.ladder);
        for (set_of, cycles) in [(&best.set, best.cycles), (&last.set, last.cycles)] {
            let all = [&[set.to_owned()], set_of.as_slice()].concat();
            assert_eq!(run(&all, AnalysisPolicy::Never).frame_cycles(), cycles, "{set}");
        }
        let longest = &whole.critical_path.as_ref().unwrap().parts[0];
        assert_eq!((longest.resource.as_str(), longest.what.as_str()), ("display", "refresh"), "{set}");
        assert!(2 * longest.cycles > whole.frame_cycles(), "{set}: {longest:?}");
        assert_eq!(longest.frames.iter().sum::<u64>(), longest.cycles, "{set}");
    }
}

// Claim: analysis: Bottlenecks and ladder do not depend on the number of threads.
#[test]
fn bottlenecks_do_not_depend_on_threads() {
    for machine in MACHINES {
        let whole = || ran(machine, machine.demos[0], [40, 30], &vec![], AnalysisPolicy::Always);
        let (threaded, alone) = (whole(), basrelief_threads::sequential(whole));
        assert_eq!(bottlenecks(&threaded), bottlenecks(&alone), "{}", machine.name);
    }
}

// Claim: analysis: Resources that are saturated together are found, although none of them saves much alone.
#[test]
fn saturated_resources_are_found_together() {
    let bump = MachineInfo::named("bump").unwrap();
    let whole = ran(bump, "gallery", [160, 120], &vec![], AnalysisPolicy::Always);
    let of = bottlenecks(&whole);
    let balanced = of.balanced.as_ref().expect("a group");
    let saturated = ["rasterizer", "depth-test", "graphics", "frame-buffer"];
    for name in saturated {
        assert!(balanced.relaxed.iter().any(|resource| resource == name), "{name}: {balanced:?}");
        let alone = of.single.iter().find(|single| single.resource == name).map_or(0, |single| single.saved);
        assert!(10 * alone < whole.frame_cycles(), "{name} alone saves {alone} cycles");
    }
    assert!(balanced.saved > 0.5, "{balanced:?}");
    // Two rungs add these units: pairs that are busy equally long. Most of the saving appears with the second.
    let in_order = of.ladder.last().unwrap().relaxed.iter().filter(|name| saturated.contains(&name.as_str()));
    assert_eq!(in_order.collect::<Vec<_>>(), saturated);
    let rungs_with = |all: bool| {
        let has = move |rung: &&RelaxedSet| saturated.map(|name| rung.relaxed.iter().any(|of| of == name)).iter().all(|has| *has);
        of.ladder.iter().filter(move |rung| has(rung) == all)
    };
    let (before, whole_group) = (rungs_with(false).next_back().unwrap(), rungs_with(true).next().unwrap());
    let added = &whole_group.relaxed[before.relaxed.len()..];
    assert_eq!(added, ["graphics", "frame-buffer"], "{:?}", of.ladder);
    assert!(before.saved < 0.3 && whole_group.saved > 0.5, "{:?}", of.ladder);
    for rung in [before, whole_group, balanced] {
        let by_hand = ran(bump, "gallery", [160, 120], &settings(&rung.set), AnalysisPolicy::Never).frame_cycles();
        assert_eq!(by_hand, rung.cycles, "{rung:?}");
        let share = 1.0 - by_hand as f64 / whole.frame_cycles() as f64;
        assert!((rung.saved - share).abs() < 1e-6, "{rung:?}");
    }
}

// Claim: analysis: No rung takes fewer cycles than a unit that it does not relax is busy.
#[test]
fn unrelaxed_units_bound_each_rung() {
    for machine in MACHINES {
        let whole = ran(machine, machine.demos[0], [40, 30], &vec![], AnalysisPolicy::Always);
        for rung in &bottlenecks(&whole).ladder {
            let open = whole.units.iter().flatten().filter(|(name, _)| !rung.relaxed.contains(name));
            // A display stays busy after the frames.
            let busy = open.map(|(_, unit)| unit.busy).filter(|busy| *busy <= whole.frame_cycles());
            assert!(busy.max() <= Some(rung.cycles), "{}: {rung:?}", machine.name);
        }
    }
}

// Claim: analysis: A ladder relaxes all other resources at once as soon as they save at most a twentieth of what all save.
#[test]
fn last_rung_relaxes_all_other_resources() {
    for machine in MACHINES {
        let whole = ran(machine, machine.demos[0], [40, 30], &vec![], AnalysisPolicy::Always);
        let of = bottlenecks(&whole);
        let (last, before) = of.ladder.split_last().expect("a ladder");
        assert!(last.relaxes_all && before.iter().all(|rung| !rung.relaxes_all), "{}: {:?}", machine.name, of.ladder);
        let single = of.single.iter().filter(|single| !last.relaxed.contains(&single.resource)).collect::<Vec<_>>();
        assert!(single.is_empty(), "{}: {single:?}", machine.name);
        let saves_enough = |rung: &RelaxedSet| 20 * (rung.cycles - last.cycles) <= whole.frame_cycles() - last.cycles;
        let (stop, earlier) = before.split_last().expect("a rung of some resources");
        assert!(saves_enough(stop) && !earlier.iter().any(saves_enough), "{}: {:?}", machine.name, of.ladder);
    }
}

// Claim: analysis: A ladder tells a memory from a unit of the same name.
#[test]
fn resources_of_a_ladder_have_names_of_their_own() {
    let bump = MachineInfo::named("bump").unwrap();
    let units: Vec<String> = bump.units().into_iter().map(|unit| unit.name).collect();
    let keys: Vec<String> = bump.parameters().into_iter().map(|parameter| parameter.key).collect();
    assert!(units.iter().any(|unit| unit == "graphics") && keys.iter().any(|key| key.starts_with("memory.graphics.")));
    let report = ran(bump, "gallery", [40, 30], &vec![], AnalysisPolicy::Always);
    let last = bottlenecks(&report).ladder.last().unwrap();
    let is_named = |resource: &str| {
        let is_group = keys.iter().any(|key| key.starts_with(&format!("{resource}.")) && resource.contains('.'));
        is_group || units.iter().any(|unit| unit == resource)
    };
    for (at, resource) in last.relaxed.iter().enumerate() {
        assert!(!last.relaxed[..at].contains(resource), "{resource} twice in {last:?}");
        assert!(is_named(resource), "{resource} is no unit and no group of parameters");
    }
    // Single relaxations have names of the same kind. The name of a memory is tested below.
    assert!(bottlenecks(&report).single.iter().all(|single| is_named(&single.resource)), "{:?}", bottlenecks(&report).single);
    let groups: Vec<&str> = last.relaxed.iter().filter_map(|resource| Some(resource.split_once('.')?.0)).collect();
    assert!(groups.contains(&"memory") && groups.contains(&"fifo"), "{last:?}");
}

/// Every relaxed memory has the values of the preset of the ideal machine, whatever the user set.
#[test]
fn ideal_memory_of_ladder_is_that_of_presets() {
    let machine = MachineInfo::named("bump").unwrap();
    let preset = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../presets/bump-ideal.toml");
    let preset = machine.load(&std::fs::read_to_string(preset).unwrap(), &[]).unwrap().to_value();
    let own: Settings =
        [("memory.graphics.part", "sdr-100"), ("memory.graphics.cl", "40"), ("memory.graphics.burst_cycles", "9")]
            .map(|(key, value)| (key.into(), value.into()))
            .to_vec();
    let report = ran(machine, "golf-ball", [40, 30], &own, AnalysisPolicy::Always);
    let single = bottlenecks(&report).single.iter().find(|limit| limit.what == IDEAL_MEMORY).expect("a slow memory");
    let memory = single.resource.strip_prefix("memory.").expect("the name of a memory");
    let all = own.iter().cloned().chain(settings(&single.set)).collect();
    let config: Value = Overrides { toml: String::new(), settings: all }.config(machine, &[]).unwrap().to_value();
    assert_eq!(config["memory"][memory], preset["memory"][memory]);
}
