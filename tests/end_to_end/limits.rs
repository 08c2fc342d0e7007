//! Absurd numbers lead to a run or an error within seconds and within a gibibyte of address space.

use crate::support::{Outcome, PROGRAM, Place, finish};
use std::fs;
use std::process::Command;

/// Address space \[KiB\].
const LIMIT: u32 = 1 << 20;

/// Runs a command line with this address space. A program that requests more ends by a signal.
fn run(place: &Place, line: &str) -> Outcome {
    let limited = place.command(line);
    let mut shell = Command::new("sh");
    shell.arg("-c").arg(format!("ulimit -v {LIMIT} && exec \"$0\" \"$@\"")).arg(PROGRAM).args(limited.get_args());
    finish(shell.current_dir(place.path("")).stdin(std::process::Stdio::null()))
}

#[test]
fn absurd_settings_stay_within_memory_limit() {
    let place = Place::new();
    for settings in [
        "--max-cycles 18446744073709551615",
        "--set replacement.entries=65536",
        "--set replacement.entries=65536 --set brightness.levels=8 --set replacement.tables=identical",
        "--set replacement.entries=65536 --set replacement.table=polyhedron",
        "--set replacement.entries=65536 --set replacement.codebook=per_object",
        "--set replacement.entries=65536 --set replacement.codebook=per_polygon --set replacement.kmeans_iterations=64",
        "--set fifo.pixels.depth=65536 --set fifo.shaded.depth=65536 --set fifo.pseudo_normals.depth=65536",
        "--set graphics.draw=after_list --set graphics.hold_fragments=67108864 --set graphics.held=normal",
        "--set replacement.gather_bytes=4294967296 --set replacement.codebook=per_object",
        "--set cache.normal_map.sets=65536 --set cache.normal_map.ways=64 --set cache.normal_map.line_bytes=4096",
        "--set cache.depth.sets=65536 --set cache.depth.ways=64 --set cache.clut.sets=65536 --set cache.clut.ways=64",
        "--set memory.graphics.banks=1024 --set memory.graphics.row_bytes=1048576 --set memory.graphics.outstanding=65536",
        "--set memory.graphics.burst_bytes=4 --set memory.graphics.burst_cycles=1024 --set memory.graphics.rp=1024",
        "--set replacement.lanes=1 --set replacement.pipelined=false --set replacement.latency=1024",
        "--set geometry.multipliers=1 --set geometry.fetch_bytes_per_cycle=1 --set operators.power.latency=1024 --set operators.power.interval=1024",
        "--set clock.hz=1 --set display.mode=fifo",
        "--set clock.hz=1 --set memory.graphics.part=custom --set memory.normal_map.part=custom --set display.pixel_hz=1",
        "--set memory.graphics.channels=64 --set memory.graphics.window=256 --set memory.graphics.cap=65536",
        "--light 1e300,1e300,-1e300 --orbit 1e300 --frames 2",
    ] {
        let outcome = run(&place, &format!("run {} --size 24x18 --quiet {settings}", patch()));
        let code = outcome.code();
        assert!((0..=2).contains(&code) && !outcome.err.contains("panicked"), "{settings}: {code}: {}", outcome.err);
        assert!(outcome.seconds < 30.0, "{settings}: took {} s", outcome.seconds);
    }
}

fn patch() -> String {
    crate::support::patch().display().to_string()
}

#[test]
fn image_size_and_frame_count_are_bounded() {
    let place = Place::new();
    for line in ["demo --size 16384x16384", "demo --size 0x1", "demo --size 99999x1", "demo --frames 0", "demo --frames 1000001"]
    {
        run(&place, line).error(2);
    }
    assert!(run(&place, "demo --size -640x480").error(2).contains("expected WIDTHxHEIGHT"), "a minus is no other option");
    let huge = r#"{"begin":{"format":"basrelief-display-list","version":1,"width":16384,"height":16384,"generator":"x"}}"#;
    fs::write(place.path("t.jsonl"), format!("{huge}\n{{\"end\":{{\"commands\":1}}}}\n")).expect("written");
    assert!(run(&place, "run t.jsonl").error(1).contains("t.jsonl: line 1"), "size");
    // Frames are streamed, so little is prepared before the first frame.
    let outcome = run(&place, &format!("run {} --size 16x12 --frames 20000 --max-cycles 1000", patch()));
    assert!(outcome.error(1).contains("--max-cycles"), "{}", outcome.err);
}

/// Meshes of many parts are used by many nodes. The number of objects is the product.
#[test]
fn million_objects_run_or_are_refused() {
    let place = Place::new();
    for (primitives, nodes, words) in [(40, 60, "--max-cycles"), (700, 1500, "--max-cycles"), (4000, 4000, "over the limit of")] {
        let parts = vec![r#"{"attributes":{"POSITION":0}}"#; primitives].join(",");
        let nodes = vec![r#"{"mesh":0}"#; nodes].join(",");
        let model = format!(
            r#"{{"asset":{{"version":"2.0"}},"nodes":[{nodes}],"meshes":[{{"primitives":[{parts}]}}],
            "accessors":[{{"componentType":5126,"count":3,"type":"VEC3"}}]}}"#
        );
        fs::write(place.path("m.gltf"), model).expect("written");
        let outcome = run(&place, "run m.gltf --max-cycles 2000 --size 64x48 --quiet --no-exact");
        assert!(outcome.error(1).contains(words), "{primitives}: {}", outcome.err);
        assert!(outcome.seconds < 20.0, "{primitives}: took {} s", outcome.seconds);
    }
}

#[test]
fn cycle_limit_holds_for_any_input() {
    let place = Place::new();
    // A million vertices without data, used by fifty nodes.
    let nodes = vec![r#"{"mesh":0}"#; 50].join(",");
    let numbers = (0..50).map(|i| i.to_string()).collect::<Vec<_>>().join(",");
    let model = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[{numbers}]}}],"nodes":[{nodes}],"meshes":[{{"primitives":
        [{{"attributes":{{"POSITION":0}}}}]}}],"accessors":[{{"componentType":5126,"count":1048576,"type":"VEC3"}}]}}"#
    );
    fs::write(place.path("m.gltf"), model).expect("written");
    let outcome = run(&place, "run m.gltf --max-cycles 20000 --size 64x48 --quiet");
    assert!(outcome.error(1).contains("--max-cycles"), "{}", outcome.err);
    assert!(outcome.seconds < 20.0, "m.gltf: took {} s", outcome.seconds);
    // A thousand frames of these demos take minutes. Drawing up to the limit takes a moment.
    for demo in ["coin", "--machine shade", "--machine defer"] {
        let outcome = run(&place, &format!("demo {demo} --frames 10000 --max-cycles 20000 --size 64x48 --quiet"));
        assert!(outcome.error(1).contains("--max-cycles"), "{demo}: {}", outcome.err);
        assert!(outcome.seconds < 20.0, "{demo}: took {} s", outcome.seconds);
    }
}
