//! Equal reports of both engines, equal pictures of the functional model, conservation of cycles, and freedom from deadlocks.

use crate::common;
use crate::common::machine_runs::assert_rejected;
use crate::common::settings::borrowed;
use crate::texel::recipe::{display_lists, meanings, timings};
use crate::texel::runs::{Ran, config, functional, machine, replay, scene_front, small_demo, timed};
use basrelief_kernel::stats::FigureValue;
use basrelief_machines::texel::{FrontEnd, TexelMachineConfig};
use proptest::prelude::*;

/// Runs both engines and the functional model, asserts that they agree, and returns the timed run.
fn agree(front: impl Fn() -> FrontEnd, config: &TexelMachineConfig) -> Ran {
    let timed = common::agree(|| machine(front(), config));
    conserved(&timed);
    timed
}

/// Asserts relations between counters.
fn conserved(ran: &Ran) {
    let Some(FigureValue::Counts(lengths)) = ran.facts.get("segment_lengths") else { panic!("{:?}", ran.facts) };
    let segments: u64 = lengths.iter().sum();
    assert_eq!(segments, ran.count("segments"), "the histogram holds every segment");
    assert!(ran.count("points_divided") >= ran.count("division_points"));
    assert!(ran.facts.count("z_passed") <= ran.facts.count("z_tested"), "both are 0 without a depth test");
    assert!(ran.count("pixels") <= ran.count("fragments"));
}

// Claim: texel, engines: Both engines and the functional model agree on traces, configurations and demos. Timing changes no image.
#[test]
fn engines_agree_on_demos_by_every_method() {
    for demo in ["corridor", "turntable"] {
        let scene = small_demo(demo);
        for method in ["adaptive", "exact", "fixed", "subpolygon"] {
            let config = config(&[("texel.method", method)]);
            let ran = agree(|| scene_front(&scene, &config), &config);
            assert!(ran.frames[0].covered.iter().any(|c| *c));
        }
    }
}

#[test]
fn incompatible_parameters_are_rejected_with_a_key() {
    let rejected = assert_rejected::<TexelMachineConfig>;
    rejected(&[("cache.texture.line_bytes", "48")], "cache.texture.line_bytes");
    rejected(&[("cache.depth.line_bytes", "48")], "cache.depth.line_bytes");
    rejected(&[("cache.depth.line_bytes", "32")], "cache.depth.line_bytes");
    rejected(&[("memory.texture.outstanding", "8")], "memory.texture.outstanding");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases / 2, ..ProptestConfig::default() })]

    // Claim: as engines_agree_on_demos_by_every_method.
    #[test]
    fn engines_agree_on_every_display_list_and_configuration(
        list in display_lists(), meaning in meanings(), timing in timings(),
    ) {
        let config = config(&[borrowed(&meaning), roomy(borrowed(&timing))].concat());
        agree(|| replay(&list, &config), &config);
    }

    // Claim: as engines_agree_on_demos_by_every_method.
    #[test]
    fn law_6_timing_never_changes_a_picture(list in display_lists(), meaning in meanings(), timing in timings()) {
        let plain = config(&borrowed(&meaning));
        let (frames, _) = functional(replay(&list, &plain), &plain);
        prop_assert_eq!(timed(&list, &[borrowed(&meaning), roomy(borrowed(&timing))].concat()).frames, frames);
    }
}

/// Adds enough credits for a step with any cache line size.
fn roomy<'a>(mut settings: Vec<(&'a str, &'a str)>) -> Vec<(&'a str, &'a str)> {
    settings.push(("memory.texture.outstanding", "1024"));
    settings
}
