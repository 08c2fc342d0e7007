//! Scene to trace and back: pictures and timing of a replayed trace.

use crate::common::demo_scene;
use basrelief_geometry_processor::SceneDraws;
use basrelief_kernel::{MemoryPorts, Unit};
use basrelief_machines::FrontConfig;
use basrelief_machines::bump::BumpProcessorConfig;
use basrelief_parameters::load;
use basrelief_reference::{QualityMetrics, RgbPicture};
use basrelief_report::Report;
use basrelief_report::model::Figure;
use basrelief_scene::ViewOptions;
use basrelief_signals::{Control, Scene};
use basrelief_sim::{FramePictures, NoObserver, Observer, RunInput, RunOptions, display_list, run, trace_header};
use basrelief_trace::{BeginCommand, TraceEncoding, TraceForm, TraceRecorder};
use std::io::{self, Cursor, Read};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

fn scene(name: &str, frames: u32) -> Arc<Scene> {
    let options = ViewOptions { size: [64, 48], frames: Some(frames), ..ViewOptions::default() };
    demo_scene(name, &options)
}

fn config(settings: &[(&str, &str)]) -> BumpProcessorConfig {
    load("", settings).unwrap()
}

fn recorded(scene: &Arc<Scene>, config: &BumpProcessorConfig, encoding: TraceEncoding) -> Vec<u8> {
    let begin: BeginCommand = trace_header(scene);
    let mut recorder = TraceRecorder::new(Vec::new(), TraceForm { encoding, ..TraceForm::default() }, begin).unwrap();
    display_list(scene, &config.clone().into()).for_each(|control| recorder.record(&control).unwrap());
    recorder.finish(Vec::new()).unwrap()
}

fn report(source: RunInput, config: &BumpProcessorConfig) -> Report {
    let settings = RunOptions { config: config.clone().into(), exact: false, ..RunOptions::default() };
    run(source, &settings, &mut NoObserver, None).unwrap().report
}

/// Runs the scene and its trace.
fn both(scene: &Arc<Scene>, config: &BumpProcessorConfig, encoding: TraceEncoding) -> [Report; 2] {
    let trace = RunInput::trace(Cursor::new(recorded(scene, config, encoding)), "recorded");
    [report(RunInput::scene(Arc::clone(scene)), config), report(trace, config)]
}

/// Returns the figures of the units after the front end.
fn behind_the_list(report: &Report) -> Vec<(&String, &Figure)> {
    let front =
        ["triangles", "polygons", "bump_polygons", "vertices", "vertex_cache_hits", "display_list_commands", "vertex_bytes"];
    let in_front = |name: &str| front.contains(&name) || name.starts_with("triangles_") || name.starts_with("vertices_");
    report.figures.iter().filter(|(name, _)| !in_front(name) && *name != "polygons_clipped").collect()
}

/// Returns the bytes of each memory and client. The display reads as long as the run lasts, so it is left out.
fn bytes(report: &Report) -> Vec<(&String, &String, u64, u64)> {
    let memories = report.memories.iter().flatten();
    let all = memories.flat_map(|(m, r)| r.clients.iter().map(move |(c, t)| (m, c, t.read_bytes, t.write_bytes)));
    all.filter(|(_, client, ..)| *client != "scan_out").collect()
}

// Claim: trace: A scene and its trace have the same hash, images, figures and bytes, in JSON and binary.
#[test]
fn replay_draws_the_same_picture_and_moves_the_same_bytes() {
    for (name, frames) in [("mixed", 1), ("coin", 3), ("brick", 1)] {
        let scene = scene(name, frames);
        for encoding in [TraceEncoding::JsonLines, TraceEncoding::Binary] {
            for settings in [&[][..], &[("display_list.arrival", "asap"), ("rasterizer.early_z", "false")]] {
                let [drawn, replayed] = both(&scene, &config(settings), encoding);
                assert_eq!(drawn.input.sha256, replayed.input.sha256, "the same input");
                assert_eq!(drawn.image, replayed.image, "{name}: the same pictures to the bit");
                assert_eq!(drawn.image.len(), frames as usize);
                assert_eq!(behind_the_list(&drawn), behind_the_list(&replayed));
                assert_eq!(bytes(&drawn), bytes(&replayed));
                assert_eq!(drawn.camera, replayed.camera);
            }
        }
    }
}

fn total(report: &Report) -> u64 {
    report.cycles.as_ref().unwrap().total
}

/// Returns the cycles between the delivery of the last command by a replay and by the geometry processor, both without backpressure. A
/// trace contains only the arrival of polygons, but culled triangles after the last polygon take time, too.
fn tail(scene: &Arc<Scene>, config: &BumpProcessorConfig) -> u64 {
    let mut geometry = FrontConfig::from(config).geometry_processor();
    let mut replayed = 0;
    for draw in SceneDraws::new(Arc::clone(scene)) {
        match geometry.step(Some(draw), &mut MemoryPorts::default()).out {
            Some(Control::Polygon(polygon)) => replayed = polygon.arrival,
            Some(_) => replayed += 1,
            None => {}
        }
    }
    geometry.state.arrival - replayed
}

/// With room for the whole trace, the front end is never blocked. A replay has no host and no FIFO after
/// it, so a polygon reaches the rasterizer exactly `fifo.draws.latency` cycles earlier than in the scene's run. The run is shorter by that
/// much, and by up to the tail if the end of the last frame waits for the geometry processor. Displays
/// and refreshes come at fixed times, which a shift by some cycles meets otherwise, so they are off.
// Claim: trace: A replay takes the cycles of the run, except for delays of the front end.
#[test]
fn replay_takes_the_cycles_of_the_run_without_front_end() {
    let unblocked = ("fifo.polygons.depth", "65536");
    let [graphics, quantization] = ["memory.graphics.refi", "memory.quantization.refi"].map(|key| (key, "0"));
    let timeless = [("display.enabled", "false"), graphics, quantization, ("memory.normal_map.refi", "0")];
    let slow = [unblocked, ("geometry.multipliers", "1"), ("geometry.dividers", "1")];
    let fast = [
        unblocked,
        ("geometry.multipliers", "256"),
        ("geometry.adders", "256"),
        ("geometry.dividers", "256"),
        ("geometry.square_roots", "256"),
        ("geometry.powers", "256"),
        ("geometry.fetch_bytes_per_cycle", "4096"),
        ("geometry.link_bytes", "4096"),
        ("fifo.draws.latency", "9"),
    ];
    for (name, frames) in [("mixed", 1), ("coin", 2), ("golf-ball", 2)] {
        for settings in [&slow[..], &fast] {
            let (scene, config) = (scene(name, frames), config(&[settings, &timeless].concat()));
            let [drawn, replayed] = both(&scene, &config, TraceEncoding::Binary);
            let (latency, tail) = (u64::from(config.fifo.draws.latency), tail(&scene, &config));
            let shorter = total(&drawn).checked_sub(total(&replayed)).unwrap();
            println!("{name} {settings:?}: {shorter} cycles shorter, latency {latency}, tail {tail}");
            assert!((latency..=latency + tail).contains(&shorter));
        }
    }
    // Nothing is culled behind the coin's last polygon, and its fragments take longer than that polygon did.
    let (coin, config) = (scene("coin", 2), config(&[&fast[..], &timeless].concat()));
    let [drawn, replayed] = both(&coin, &config, TraceEncoding::JsonLines);
    assert_eq!(total(&drawn) - total(&replayed), u64::from(config.fifo.draws.latency));
}

/// Time that reads of a [`SlowTrace`] have taken \[s\].
static READING: AtomicU32 = AtomicU32::new(0);

/// Trace of which each read takes a second on an otherwise stopped clock.
struct SlowTrace(Cursor<Vec<u8>>);

impl Read for SlowTrace {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        READING.fetch_add(1, Ordering::Relaxed);
        self.0.read(bytes)
    }
}

#[test]
fn reading_a_trace_is_not_simulation_time() {
    let config = config(&[]);
    let trace = SlowTrace(Cursor::new(recorded(&scene("mixed", 1), &config, TraceEncoding::Binary)));
    let clock = || f64::from(READING.load(Ordering::Relaxed));
    let settings = RunOptions { config: config.into(), exact: false, clock, ..RunOptions::default() };
    let run = run(RunInput::trace(trace, "slow"), &settings, &mut NoObserver, None).unwrap();
    assert!(clock() > 10.0, "{} readings", clock());
    assert_eq!(run.simulate_s, 0.0);
}

/// A frame, the machine's image of it, and the reference image.
type ShownFrame = (usize, RgbPicture, Option<(RgbPicture, QualityMetrics)>);

/// Frames that an observer has received, in order.
#[derive(Default, PartialEq)]
struct Shown(Vec<ShownFrame>);

impl Observer for Shown {
    fn frame(&mut self, pictures: &FramePictures<'_>) -> Result<(), String> {
        let exact = pictures.exact.map(|(picture, quality)| (picture.clone(), quality));
        self.0.push((pictures.index, pictures.machine.clone(), exact));
        Ok(())
    }
}

/// Returns the frames of a run with reference images, and its report.
fn shown(source: RunInput, max_cycles: u64) -> (Shown, String) {
    let mut shown = Shown::default();
    let report = run(source, &RunOptions { max_cycles, ..RunOptions::default() }, &mut shown, None).unwrap().report;
    (shown, report.to_json().unwrap())
}

/// Other tests of this file run concurrently; their results do not depend on threads either.
#[test]
fn run_does_not_depend_on_the_number_of_threads() {
    let coin = scene("coin", 3);
    let trace = recorded(&coin, &config(&[]), TraceEncoding::Binary);
    let all = || {
        let replayed = shown(RunInput::trace(Cursor::new(trace.clone()), "recorded"), u64::MAX);
        [shown(RunInput::scene(Arc::clone(&coin)), u64::MAX), shown(RunInput::scene(Arc::clone(&coin)), 60_000), replayed]
    };
    let threaded = all();
    basrelief_threads::disable_threads();
    assert_eq!(basrelief_threads::workers(), 1);
    let alone = all();
    assert!(threaded == alone, "the same pictures, in the same order, and the same reports");
    let [drawn, stopped, replayed] = threaded.each_ref().map(|(shown, _)| shown.0.len());
    assert!(drawn == 3 && stopped < 3 && replayed == 3, "{drawn}, {stopped}, {replayed}");
}
