//! Costs: every cycle of every unit is charged exactly once.

use crate::common::demo_scene;
use basrelief_input::MemoryPool;
use basrelief_kernel::{CycleAccount, Engine, Recorder, RunReport};
use basrelief_report::costs::CycleBreakdown as Told;
use basrelief_report::model::Figure;
use basrelief_scene::ViewOptions;
use basrelief_signals::Scene;
use basrelief_sim::{
    AnalysisPolicy, AuxOutput, CostKind, CycleBreakdown, MachineInfo, NoObserver, Observer, PARTS, RunCosts, RunInput,
    RunOptions, RunResult, display_list, run, trace_header,
};
use std::cmp::Reverse;
use std::sync::Arc;

const FAST: (&str, &str) = ("path.bits_per_second", "30000000000");
const LOCAL: (&str, &str) = ("path.latency_us", "0");

/// Demos with settings: one per machine, and one per alternative path in it. Meshes are coarse and paths fast, because the ticked
/// engine visits every unit in every cycle.
const CASES: [(&str, &[(&str, &str)]); 12] = [
    ("mixed", &[]),
    ("golf-ball", &[("rasterizer.early_z", "false")]),
    ("mixed", &[("replacement.codebook", "per_object")]),
    ("mixed", &[("rasterizer.stamp", "1"), ("replacement.codebook", "per_polygon")]),
    ("goblet@2", &[]),
    ("goblet@2", &[("frame_memory.depth_test", "false"), ("host.buffers", "1")]),
    ("ellipsoid@2", &[("shade.mode", "brightness")]),
    ("corridor", &[]),
    ("turntable", &[("mip.mode", "off"), ("texel.method", "exact")]),
    ("corridor", &[("pixel_value_buffer.depth_test", "false")]),
    ("gallery", &[FAST, LOCAL]),
    ("gallery", &[FAST, LOCAL, ("defer.mode", "progressive")]),
];

fn scene(name: &str, frames: u32) -> Arc<Scene> {
    let options = ViewOptions { size: [64, 48], frames: Some(frames), ..ViewOptions::default() };
    demo_scene(name, &options)
}

fn options(demo: &str, settings: &[(&str, &str)]) -> RunOptions {
    let config = MachineInfo::of_demo(demo).load("", settings);
    let config = config.unwrap_or_else(|error| panic!("{demo} {settings:?}: {error}"));
    RunOptions { config, exact: false, costs: true, ..RunOptions::default() }
}

fn costs(name: &str, settings: &[(&str, &str)], change: impl Fn(&mut RunOptions)) -> (RunCosts, RunResult) {
    costs_of(&scene(name, 2), options(name, settings), change)
}

fn costs_of(scene: &Arc<Scene>, mut options: RunOptions, change: impl Fn(&mut RunOptions)) -> (RunCosts, RunResult) {
    change(&mut options);
    let mut ran = run(RunInput::scene(Arc::clone(scene)), &options, &mut NoObserver, None).unwrap();
    (ran.costs.take().unwrap(), ran)
}

/// Compares costs with the accounts of the units.
fn check(costs: &RunCosts, report: &RunReport) {
    assert_eq!((costs.cycles, costs.units.len()), (report.total, report.units.len()));
    for (unit, own) in costs.units.iter().zip(&report.units) {
        let CycleAccount { busy, done, starved, memory, blocked } = &own.account;
        for way in &unit.activities {
            let at = |names: &[String]| names.iter().position(|name| *name == way.of).unwrap();
            let cycles = match way.kind {
                CostKind::Busy => *busy,
                CostKind::Starved => starved[at(&own.inputs)],
                CostKind::Memory => memory[at(&own.clients)],
                CostKind::Blocked => blocked[at(&own.outputs)],
            };
            let name = format!("{} {:?} {}", unit.unit, way.kind, way.of);
            assert_eq!(way.on_pixels + way.non_pixel + way.unattributed, cycles, "{name}");
            assert_eq!(way.parts.iter().sum::<u64>(), way.on_pixels * PARTS, "{name}: to the part of a cycle");
        }
        let ways: u64 = unit.activities.iter().map(|way| way.on_pixels + way.non_pixel + way.unattributed).sum();
        assert_eq!((unit.done, ways + unit.done), (*done, report.total), "{}", unit.unit);
    }
}

// Claim: as segment_belongs_to_its_first_step.
#[test]
fn critical_path_by_polygon_sums_to_the_cycle() {
    for (name, settings) in [CASES[0], CASES[4], CASES[7], CASES[10]] {
        let (costs, run) = costs(name, settings, |options| options.bottlenecks = AnalysisPolicy::Always);
        let path = run.report.critical_path.unwrap();
        let by_polygon = path.polygons.unwrap();
        let listed: u64 = by_polygon.listed.iter().map(|polygon| polygon.cycles).sum();
        assert_eq!(listed + by_polygon.others + by_polygon.elsewhere, path.cycles, "{name} {settings:?}");
        assert!(by_polygon.listed.is_sorted_by_key(|polygon| Reverse(polygon.cycles)));
        for on_path in &by_polygon.listed {
            let polygon = costs.polygons.iter().find(|p| (p.frame, p.number) == (on_path.frame, on_path.polygon)).unwrap();
            // Work that begins with the last step of a polygon may continue after its end.
            assert!(polygon.life[0] < path.cycles && polygon.object == on_path.object, "{name} {settings:?} {on_path:?}");
        }
    }
}

fn sum<'a>(spent: impl IntoIterator<Item = &'a Told>) -> u64 {
    spent.into_iter().map(|spent| spent.cycles).sum()
}

#[test]
fn costs_of_all_recipients_sum_to_unit_cycles() {
    for (name, settings) in CASES {
        let (costs, run) = costs(name, settings, |_| {});
        println!("{name} {settings:?}");
        let timing = run.timing.as_ref().unwrap();
        check(&costs, timing);
        let told = run.report.costs.as_ref().unwrap();
        assert_eq!(told.unit_cycles, costs.cycles * costs.units.len() as u64);
        assert_eq!(sum([&told.pixels, &told.non_pixel, &told.unattributed]) + told.done, told.unit_cycles);
        assert_eq!(sum(&told.frames), sum([&told.pixels, &told.non_pixel]), "all is for some frame");
        let objects = sum(told.objects.iter().map(|o| &o.breakdown)) + told.other_objects.breakdown.cycles;
        let polygons = sum(told.polygons.iter().map(|p| &p.breakdown)) + told.other_polygons.breakdown.cycles;
        assert!(polygons <= objects && objects <= sum(&told.frames));
        // In a complete run, only an unused unit has waits for no token.
        for unit in &costs.units {
            let unused = unit.activities.iter().all(|way| way.on_pixels + way.non_pixel == 0);
            assert!(unused || unit.activities.iter().all(|way| way.unattributed == 0), "{}", unit.unit);
        }
        assert!(told.pixels.busy > 0 && told.non_pixel.busy > 0);
    }
}

#[test]
fn costs_of_a_limited_run_sum_to_its_cycles() {
    for (name, settings) in CASES {
        let (scene, options) = (scene(name, 1), options(name, settings));
        let whole = costs_of(&scene, options.clone(), |_| {}).0.cycles;
        for max_cycles in [1, whole / 3, whole / 2 + 7] {
            let (costs, run) = costs_of(&scene, options.clone(), |options| options.max_cycles = max_cycles);
            check(&costs, run.timing.as_ref().unwrap());
        }
    }
}

#[test]
fn engines_charge_the_same_cycles_to_each_pixel() {
    for (name, settings) in CASES {
        let scene = scene(name, 1);
        let [(timed, one), (ticked, other)] =
            [Engine::Timed, Engine::Ticked].map(|engine| costs_of(&scene, options(name, settings), |o| o.engine = Some(engine)));
        assert!(timed.units == ticked.units, "{name} {settings:?}");
        assert!(timed.polygons == ticked.polygons && one.report == other.report, "{name} {settings:?}");
        let [width, height] = timed.size();
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            assert_eq!(timed.pixel(x, y), ticked.pixel(x, y), "{name} {settings:?}");
        }
    }
}

#[test]
fn pixel_costs_have_a_breakdown_within_the_picture() {
    let (costs, _) = costs("mixed", &[], |_| {});
    assert_eq!(costs.size(), [64, 48]);
    assert!(costs.pixel(64, 0).is_none() && costs.pixel(0, 48).is_none() && costs.pixel(u32::MAX, 0).is_none());
    let middle = costs.pixel(32, 24).unwrap();
    let ways: f64 = middle.activities.iter().map(|way| way.cycles).sum();
    assert!((ways - middle.cycles).abs() < 1e-6 && middle.cycles > 0.0, "{middle:?}");
    assert!(middle.activities.windows(2).all(|pair| pair[0].cycles >= pair[1].cycles));
    assert!(middle.overdraw >= 2 && middle.polygon.is_some(), "{middle:?}");
    let mut sum = 0.0;
    for (x, y) in (0..48).flat_map(|y| (0..64).map(move |x| (x, y))) {
        sum += costs.pixel(x, y).unwrap().cycles;
    }
    let of_units: u64 = costs.units.iter().flat_map(|unit| &unit.activities).map(|way| way.on_pixels).sum();
    assert!((sum - of_units as f64).abs() < 1e-3, "{sum} {of_units}");
}

fn count(run: &RunResult, name: &str) -> u64 {
    match run.report.figures.get(name) {
        Some(Figure::Count(n)) => *n,
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn overdraw_counts_each_fragment_at_its_pixel_and_its_polygon() {
    for (name, settings) in CASES {
        let (costs, run) = costs(name, settings, |_| {});
        let [width, height] = costs.size();
        let all = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let fragments: u64 = all.map(|(x, y)| u64::from(costs.pixel(x, y).unwrap().overdraw)).sum();
        assert_eq!(costs.polygons.iter().map(|p| p.fragments).sum::<u64>(), fragments, "{name} {settings:?}");
        assert_eq!(costs.polygons.len() as u64, count(&run, "polygons"), "{name} {settings:?}");
        assert_eq!(fragments, count(&run, "fragments"), "{name} {settings:?}");
    }
}

#[test]
fn trace_has_the_costs_of_its_scene() {
    let scene = scene("mixed", 2);
    let options = options("mixed", &[]);
    let mut recorder = basrelief_trace::TraceRecorder::new(Vec::new(), Default::default(), trace_header(&scene)).unwrap();
    display_list(&scene, &options.config).for_each(|control| recorder.record(&control).unwrap());
    let trace = RunInput::trace(std::io::Cursor::new(recorder.finish(Vec::new()).unwrap()), "recorded");
    let from_list = run(trace, &options, &mut NoObserver, None).unwrap().costs.unwrap();
    let from_scene = run(RunInput::scene(scene), &options, &mut NoObserver, None).unwrap().costs.unwrap();
    assert_eq!(from_list.polygons.len(), from_scene.polygons.len());
    for (a, b) in from_list.polygons.iter().zip(&from_scene.polygons) {
        assert_eq!((a.frame, a.number, a.object, a.fragments), (b.frame, b.number, b.object, b.fragments));
    }
    let bits = |costs: &RunCosts| costs.overdraw().iter().map(|n| n.to_bits()).collect::<Vec<_>>();
    assert!(bits(&from_list) == bits(&from_scene));
    check_sums(&from_list);
}

/// The sums over polygons are those over units.
fn check_sums(costs: &RunCosts) {
    let busy = |spent: &CycleBreakdown| spent.busy;
    let of_polygons: u64 = costs.polygons.iter().map(|p| busy(&p.spent)).sum();
    let ways = costs.units.iter().flat_map(|unit| &unit.activities).filter(|way| way.kind == CostKind::Busy);
    assert!(of_polygons <= ways.map(|way| way.on_pixels + way.non_pixel).sum());
}

#[derive(Default)]
struct Shown(Vec<String>);

impl Observer for Shown {
    fn aux_output(&mut self, exhibit: &AuxOutput<'_>) -> Result<(), String> {
        if let basrelief_sim::AuxContent::NamedPicture(name, picture) = &exhibit.content {
            let drawn = picture.covered[..64 * 48].iter().filter(|covered| **covered).count();
            assert!(drawn > 0 && drawn < 64 * 48, "{name}: {drawn} drawn, the others background");
            self.0.push(name.clone());
        }
        Ok(())
    }
}

#[test]
fn machine_makes_its_own_cost_maps() {
    let shown = |name: &str, settings| {
        let mut shown = Shown::default();
        run(RunInput::scene(scene(name, 1)), &options(name, settings), &mut shown, None).unwrap();
        shown.0
    };
    assert_eq!(shown("golf-ball", &[]), ["cost.png", "wait.png", "overdraw.png", "level.png", "entry.png"]);
    assert_eq!(shown("goblet@2", &[]), ["cost.png", "wait.png", "overdraw.png"]);
    assert_eq!(shown("turntable", &[("mip.mode", "trilinear")]), ["cost.png", "wait.png", "overdraw.png", "level.png"]);
}

#[test]
fn chained_probe_receives_the_same_events() {
    let told = |costs: bool| {
        let mut recorder = Recorder::default();
        let options = RunOptions { costs, ..options("mixed", &[]) };
        run(RunInput::scene(scene("mixed", 1)), &options, &mut NoObserver, Some(&mut recorder)).unwrap();
        recorder
    };
    assert!(told(true) == told(false));
}

#[test]
fn costs_respect_the_memory_limit() {
    let take = |bytes: u64| {
        let options = RunOptions { budget: MemoryPool::new(bytes), ..options("mixed", &[]) };
        run(RunInput::scene(scene("mixed", 1)), &options, &mut NoObserver, None).map(|_| ()).map_err(|e| e.to_string())
    };
    let whole = 64 << 20;
    assert_eq!(take(whole), Ok(()));
    // A picture of 64 x 48 pixels takes 24 KiB for each activity of a unit, and there are dozens. The limit is so small that one of these
    // allocations fails. The memory of polygons in flight depends on their addresses on the host.
    let error = take(1 << 19).unwrap_err();
    assert!(error.contains("costs") && error.contains("--memory-limit"), "{error}");
}
