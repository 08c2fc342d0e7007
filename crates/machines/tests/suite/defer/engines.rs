//! Equal reports of both engines, equal pictures of the functional model, conservation of cycles, and freedom from deadlocks.

use crate::common;
use crate::common::machine_runs::assert_rejected;
use crate::common::settings::borrowed;
use crate::defer::recipe::{FAST, SMALL, display_lists, frame, meanings, object, rectangle, timings, views};
use crate::defer::runs::{Ran, config, functional, replay, run, timed};
use basrelief_kernel::{Engine, Outcome};
use basrelief_machines::defer::DeferConfig;
use basrelief_signals::{Control, Material};
use proptest::prelude::*;
use std::sync::Arc;

/// Runs both engines and the functional model, asserts that they agree, and returns the timed run.
fn agree(list: &[Control], config: &DeferConfig) -> Ran {
    let timed = run(replay(list, config), config, Engine::Timed);
    assert_eq!(timed.report.outcome, Outcome::Complete);
    let ticked = run(replay(list, config), config, Engine::Ticked);
    common::same(&timed.report, &ticked.report);
    assert_eq!(timed.seen, ticked.seen);
    assert_eq!(timed.seen, functional(list, config), "the functional model");
    conserved(&timed);
    timed
}

/// Asserts laws 9 to 11, and relations between counters.
fn conserved(ran: &Ran) {
    common::conserved(&ran.report);
    let count = |name: &str| ran.seen.count(name);
    assert_eq!(ran.report.marks.len() as u64, count("pictures"), "each picture shown ends a frame (law 11)");
    assert_eq!(count("tiles_loaded"), count("path_tiles"));
    let parts = ["path_polygon_bytes", "path_command_bytes", "path_texture_size_bytes", "path_head_bytes", "path_tile_bytes"];
    assert_eq!(parts.map(count).iter().sum::<u64>(), count("path_bytes"));
    assert_eq!(count("cells_textured") + count("cells_direct"), count("z_passed"));
    assert_eq!(count("pixels_textured") + count("pixels_direct"), count("pixels"));
}

// Claim: defer, engines: Both engines and the functional model agree. 28,571 cycles per byte cost the timed engine no step.
#[test]
fn engines_agree_on_the_hall_in_every_mode() {
    for mode in ["best", "progressive", "conventional"] {
        let config = config(&[FAST, SMALL, &[("defer.mode", mode)]].concat());
        let ran = agree(&views(&[0.0, 6.0]), &config);
        assert!(ran.seen.finished.iter().all(|f| f.covered.iter().any(|c| *c)));
    }
}

// Claim: as engines_agree_on_the_hall_in_every_mode.
#[test]
fn slow_path_takes_the_timed_engine_no_longer() {
    let slow = timed(&views(&[0.0]), &[SMALL, &[("path.bits_per_second", "56000"), ("path.latency_us", "100000")]].concat());
    let fast = timed(&views(&[0.0]), &[SMALL, FAST].concat());
    assert_eq!(slow.seen.finished, fast.seen.finished);
    let bytes = slow.seen.count("path_bytes");
    let cycles = bytes * 8 * config(&[]).clock.hz / 56_000;
    assert!((cycles..cycles + 60_000_000).contains(&slow.report.total), "{} cycles for {bytes} bytes", slow.report.total);
    let steps = |ran: &Ran| ran.report.units.iter().map(|u| u.steps).collect::<Vec<_>>();
    assert_eq!(steps(&slow), steps(&fast), "the work of the engine is the same");
}

#[test]
fn clear_flags_reduce_traffic_of_cells_only() {
    let plain = Arc::new(Material::default());
    let small = rectangle([4.0, 4.0, 20.0, 12.0], 0.5, &plain);
    let list = [frame(0), object(0), small, Control::FrameEnd];
    let bytes = |more: &[(&str, &str)]| {
        let ran = timed(&list, &[FAST, SMALL, more].concat());
        let ports = ran.report.memories.iter().flat_map(|memory| &memory.ports).collect::<Vec<_>>();
        let of =
            |client: &str| ports.iter().filter(|p| p.client == client).map(|p| p.counts.read_bytes + p.counts.write_bytes).sum();
        (ran.seen.finished, ["cell_read", "cell_write"].map(of))
    };
    let (picture, flagged): (_, [u64; 2]) = bytes(&[]);
    let (same, written) = bytes(&[("engine.clear_flags", "false")]);
    assert_eq!(picture, same);
    // 8 blocks are drawn, and 40 x 30 pixels have 80. Both passes read a block.
    assert_eq!(flagged.map(|bytes| bytes / 256), [2 * 8, 8]);
    assert_eq!(written.map(|bytes| bytes / 256), [2 * 80, 80 + 8]);
}

// Claim: as engines_agree_on_the_hall_in_every_mode.
#[test]
fn incompatible_parameters_are_rejected_with_a_key() {
    let rejected = assert_rejected::<DeferConfig>;
    rejected(&[("tile.width", "48")], "tile.width");
    rejected(&[("tile.height", "100")], "tile.height");
    rejected(&[("memory.texture.outstanding", "127")], "memory.texture.outstanding");
    rejected(&[("cache.texel.line_bytes", "48")], "cache.texel.line_bytes");
    rejected(&[("cache.depth.line_bytes", "48")], "cache.depth.line_bytes");
    rejected(&[("cell.depth_bits", "12")], "cell.depth_fraction_bits");
    rejected(&[("cell.coordinate_format", "fixed"), ("cell.coordinate_bits", "12")], "cell.coordinate_fraction_bits");
}

// Claim: as engines_agree_on_the_hall_in_every_mode.
#[test]
fn too_small_for_the_scene_is_a_fault_with_a_parameter() {
    for (setting, name) in
        [(("cell.page_bits", "2"), "cell.page_bits"), (("engine.texture_memory", "100000"), "engine.texture_memory")]
    {
        let config = config(&[setting]);
        let ran = run(replay(&views(&[0.0]), &config), &config, Engine::Timed);
        let Outcome::Fault(text) = &ran.report.outcome else { panic!("{:?}", ran.report.outcome) };
        assert!(text.contains(name), "{text}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases / 4, ..ProptestConfig::default() })]

    // Claim: as engines_agree_on_the_hall_in_every_mode.
    #[test]
    fn engines_agree_on_every_display_list_and_configuration(
        list in display_lists(), meaning in meanings(), timing in timings(),
    ) {
        let config = config(&[borrowed(&meaning), borrowed(&timing)].concat());
        agree(&list, &config);
    }

    // Claim: as engines_agree_on_the_hall_in_every_mode.
    #[test]
    fn law_6_timing_never_changes_a_picture_or_a_tile(list in display_lists(), meaning in meanings(), timing in timings()) {
        let plain = config(&borrowed(&meaning));
        let seen = functional(&list, &plain);
        let ran = timed(&list, &[borrowed(&meaning), borrowed(&timing)].concat()).seen;
        prop_assert_eq!((ran.finished, ran.rounds, ran.tiles), (seen.finished, seen.rounds, seen.tiles));
    }
}
