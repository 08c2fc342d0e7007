//! Equal reports of both engines, equal pictures of the functional model, conservation of cycles, and freedom from deadlocks.

use crate::bump::recipe::{meanings, scenes, timings};
use crate::bump::runs::{Ran, config, functional, machine, small_demo, timed};
use crate::common;
use crate::common::machine_runs::assert_rejected;
use crate::common::settings::borrowed;
use basrelief_kernel::RunReport;
use basrelief_machines::bump::BumpProcessorConfig;
use basrelief_scene::DEMOS;
use basrelief_signals::Scene;
use proptest::prelude::*;
use std::sync::Arc;

/// Runs a scene on both engines and the functional model, asserts that they agree, and returns the timed run.
fn agree(scene: &Arc<Scene>, config: &BumpProcessorConfig) -> Ran {
    let timed = common::agree(|| machine(scene, config));
    assert_eq!(timed.frames.len(), scene.frames.len());
    conserved(&timed, config, scene.frames.len());
    timed
}

/// Asserts laws 9 to 11, and relations between caches, ports and counters.
fn conserved(ran: &Ran, config: &BumpProcessorConfig, frames: usize) {
    let RunReport { total, memories, caches, marks: ends, .. } = &ran.report;
    assert_eq!(ends.len(), frames);
    // In the remaining cycles, memory takes the last pixels.
    assert!(ends.iter().all(|f| *f > 0) && ends.iter().sum::<u64>() <= *total, "{ends:?} of {total}");
    let ports = || memories.iter().flat_map(|m| &m.ports);
    let cache = &config.cache;
    for (name, client, line_bytes) in [
        ("normal_map", "texels", cache.normal_map.line_bytes),
        ("clut", "clut_read", cache.clut.line_bytes),
        ("color_texture", "color_texels", cache.color_texture.line_bytes),
        ("depth", "z_read", cache.depth.line_bytes),
    ] {
        let misses = caches.iter().find(|c| c.name == name).map(|c| c.counts.misses).unwrap();
        let port = ports().find(|p| p.client == client).map(|p| p.counts).unwrap();
        assert_eq!((port.reads, port.read_bytes), (misses, misses * u64::from(line_bytes)), "a miss is a request: {name}");
    }
    for memory in memories {
        let by_port: u64 = memory.ports.iter().map(|p| p.counts.rows.bursts()).sum();
        let by_channel: u64 = memory.channels.iter().map(|c| c.rows.bursts()).sum();
        assert_eq!(by_port, by_channel, "bursts of {}", memory.name);
    }
}

// Claim: laws, all: Both engines agree on every demo.
#[test]
fn engines_agree_on_every_demo() {
    for demo in DEMOS {
        agree(&small_demo(demo.name, 2), &config(&[]));
    }
}

#[test]
fn stamp_takes_one_depth_cache_lookup() {
    for (early_z, stamp) in [("true", "1"), ("false", "1"), ("true", "4"), ("false", "4")] {
        let ran = timed(&small_demo("mixed", 1), &[("rasterizer.early_z", early_z), ("rasterizer.stamp", stamp)]);
        let depth = ran.report.caches.iter().find(|c| c.name == "depth").unwrap().counts;
        let look_ups = depth.hits + depth.misses + depth.merged;
        let tokens = |fifo: &str| ran.report.fifos.iter().find(|f| f.name == fifo).unwrap().tokens;
        // The frame, its objects and polygons, and the end of the frame are tokens, too.
        let stamps = tokens(if early_z == "true" { "fragments" } else { "pixels" }) - tokens("polygons");
        let unknown = ran.count("z_tested") - ran.count("z_clear") - ran.count("z_gathered");
        assert!(look_ups > 0 && look_ups < stamps);
        assert!(if stamp == "1" { look_ups == unknown } else { look_ups < unknown });
        assert_eq!(ran.count("z_tested"), ran.count("fragments"));
        assert_eq!(ran.count("pixels"), ran.count("z_passed"));
    }
}

#[test]
fn gathered_lines_and_clear_flags_reduce_traffic_only() {
    let scene = small_demo("mixed", 2);
    let of_lines = |lines: &str| timed(&scene, &[("frame_buffer.write_lines", lines), ("depth.write_lines", lines)]);
    let runs = ["1", "2", "8", "64"].map(of_lines);
    for ran in &runs {
        assert_eq!(ran.bytes("pixel_write"), 64 * ran.count("pixel_lines_written"));
        assert_eq!(ran.bytes("z_write"), 64 * ran.count("z_lines_written"));
        // 64 x 48 pixels are 192 lines.
        assert_eq!(ran.count("z_clear_flags"), 192);
        assert_eq!(ran.frames, runs[0].frames);
    }
    let bytes = |client: &str| runs.iter().map(|ran| ran.bytes(client)).collect::<Vec<_>>();
    for client in ["pixel_write", "z_write"] {
        assert!(bytes(client).is_sorted_by(|few, many| few > many), "{client}: {:?}", bytes(client));
    }
    let flagless = timed(&scene, &[("depth.clear_flags", "false")]);
    assert_eq!((flagless.count("z_clear"), flagless.count("z_clear_flags")), (0, 0));
    assert_eq!(flagless.frames, runs[0].frames);
    assert!(flagless.bytes("z_read") > runs[2].bytes("z_read"));
}

#[test]
fn stamps_change_neither_picture_nor_count() {
    let scene = small_demo("mixed", 1);
    let single = timed(&scene, &[("rasterizer.stamp", "1")]);
    // The hardware differs, because FIFOs are as wide as stamps.
    let figures = |ran: &Ran| ran.facts.figures().cloned().collect::<Vec<_>>();
    for stamp in ["2", "3", "4"] {
        let ran = timed(&scene, &[("rasterizer.stamp", stamp)]);
        assert_eq!(ran.frames, single.frames);
        assert_eq!(figures(&ran), figures(&single));
        assert!(ran.bytes("texels") <= single.bytes("texels"));
    }
    let few = timed(&scene, &[("memory.normal_map.outstanding", "9"), ("memory.graphics.outstanding", "4")]);
    assert_eq!((&few.frames, figures(&few)), (&single.frames, figures(&single)), "few credits, smaller stamps");
}

// Claim: as exactly_declared_inputs_are_popped.
#[test]
fn incompatible_parameters_are_rejected_with_a_key() {
    let rejected = assert_rejected::<BumpProcessorConfig>;
    rejected(&[("brightness.levels", "3"), ("normal_mapping.filter_at", "brightness")], "normal_mapping.filter_at");
    rejected(&[("replacement.table", "tetrahedron"), ("replacement.entries", "17")], "replacement.entries");
    rejected(&[("cache.depth.line_bytes", "48")], "cache.depth.line_bytes");
    // Law 3: a step starts when there are credits for the largest step. With fewer credits it would never start.
    rejected(&[("memory.normal_map.outstanding", "7")], "memory.normal_map.outstanding");
    rejected(&[("memory.normal_map.outstanding", "31"), ("brightness.levels", "8")], "memory.normal_map.outstanding");
    rejected(&[("memory.quantization.outstanding", "1")], "memory.quantization.outstanding");
    rejected(&[("memory.graphics.outstanding", "3")], "memory.graphics.outstanding");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases / 4, ..ProptestConfig::default() })]

    // Claim: as claim_10_functional_model_gives_the_same_pictures.
    #[test]
    fn engines_agree_on_every_scene_and_configuration(scene in scenes(), meaning in meanings(), timing in timings()) {
        let settings = [borrowed(&meaning), borrowed(&timing)].concat();
        agree(&scene.scene(), &config(&settings));
    }

    // Claim: as tokens_do_not_depend_on_the_memory.
    #[test]
    fn law_6_timing_never_changes_a_picture(scene in scenes(), meaning in meanings(), timing in timings()) {
        let scene = scene.scene();
        let (frames, _) = functional(&scene, &config(&borrowed(&meaning)));
        let ran = timed(&scene, &[borrowed(&meaning), borrowed(&timing)].concat());
        prop_assert_eq!(ran.frames, frames);
    }
}
