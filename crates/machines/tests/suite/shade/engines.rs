//! Equal reports of both engines, equal pictures of the functional model, conservation of cycles, and freedom from deadlocks.

use crate::common;
use crate::common::machine_runs::assert_rejected;
use crate::common::settings::borrowed;
use crate::shade::recipe::{display_lists, meanings, timings};
use crate::shade::runs::{Ran, config, functional, machine, replay, scene_front, small_demo, timed};
use basrelief_machines::shade::{FrontEnd, ShadeConfig};
use proptest::prelude::*;

/// Runs both engines and the functional model, asserts that they agree, and returns the timed run.
fn agree(front: impl Fn() -> FrontEnd, config: &ShadeConfig) -> Ran {
    let timed = common::agree(|| machine(front(), config));
    conserved(&timed);
    timed
}

/// Asserts relations between counters.
fn conserved(ran: &Ran) {
    let paths = ["polyhedron", "brightness", "normal", "gate_closed", "flat", "reused"];
    let sum = |what: &str| paths.iter().map(|path| ran.count(&format!("{what}_{path}"))).sum::<u64>();
    assert_eq!(sum("dots"), ran.count("fragments"));
    assert_eq!(sum("polygons"), ran.count("polygons_sent"), "every polygon takes one path");
    let [linear, both] = ["interpolation_dots", "adder_sums"].map(|name| ran.count(name));
    assert_eq!(linear, ["brightness", "normal", "gate_closed"].map(|p| ran.count(&format!("dots_{p}"))).iter().sum::<u64>());
    assert_eq!((both, ran.count("gate_passed")), (ran.count("dots_normal"), ran.count("dots_normal")));
    assert_eq!(ran.count("normal_interpolation_dots"), both + ran.count("gate_blocked"));
    let busy = |name: &str| ran.report.units.iter().find(|u| u.name == name).map_or(0, |u| u.account.busy);
    assert_eq!(busy("normal-interpolation"), ran.count("normal_interpolation_started_cycles"));
    assert!(busy("interpolation") >= ran.count("interpolation_started_cycles"));
}

// Claim: shade, engines: Both engines and the functional model agree on lists, configurations, demos.
#[test]
fn engines_agree_on_demos_in_every_mode() {
    for demo in ["ellipsoid@4", "goblet@2"] {
        let scene = small_demo(demo);
        for mode in ["normal", "brightness", "polyhedron"] {
            let config = config(&[("shade.mode", mode)]);
            let ran = agree(|| scene_front(&scene, &config), &config);
            assert!(ran.frames[0].covered.iter().any(|c| *c));
        }
    }
}

#[test]
fn incompatible_parameters_are_rejected_with_a_key() {
    let rejected = assert_rejected::<ShadeConfig>;
    rejected(&[("cache.depth.line_bytes", "48")], "cache.depth.line_bytes");
    rejected(&[("host.buffers", "2"), ("fifo.finished.depth", "1")], "fifo.finished.depth");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases / 2, ..ProptestConfig::default() })]

    // Claim: as engines_agree_on_demos_in_every_mode.
    #[test]
    fn engines_agree_on_every_display_list_and_configuration(
        list in display_lists(), meaning in meanings(), timing in timings(),
    ) {
        let config = config(&[borrowed(&meaning), borrowed(&timing)].concat());
        agree(|| replay(&list, &config), &config);
    }

    #[test]
    fn law_6_timing_never_changes_a_picture(list in display_lists(), meaning in meanings(), timing in timings()) {
        let plain = config(&borrowed(&meaning));
        let (frames, _) = functional(replay(&list, &plain), &plain);
        prop_assert_eq!(timed(&list, &[borrowed(&meaning), borrowed(&timing)].concat()).frames, frames);
    }
}
