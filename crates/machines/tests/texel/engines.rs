//! Both engines give equal reports, the functional model the same pictures; cycles are conserved; nothing deadlocks.

use crate::common;
use crate::common::settings::borrowed;
use crate::recipe::{display_lists, meanings, timings};
use crate::runs::{Ran, config, functional, machine, replay, scene_front, small_demo, timed};
use basrelief_kernel::stats::FigureValue;
use basrelief_machines::texel::{FrontEnd, TexelMachineConfig, TextureMappingSystem};
use proptest::prelude::*;

/// Runs in all three ways and holds them against each other; the timed run.
fn agree<F: FrontEnd>(front: impl Fn() -> F, config: &TexelMachineConfig) -> Ran {
    let timed = common::agree(|| machine(front(), config));
    conserved(&timed);
    timed
}

/// What counters must have in common.
fn conserved(ran: &Ran) {
    let Some(FigureValue::Counts(lengths)) = ran.facts.get("segment_lengths") else { panic!("{:?}", ran.facts) };
    let segments: u64 = lengths.iter().sum();
    assert_eq!(segments, ran.count("segments"), "the histogram holds every segment");
    assert!(ran.count("points_divided") >= ran.count("division_points"));
    assert!(ran.facts.count("z_passed") <= ran.facts.count("z_tested"), "neither where there is no depth test");
    assert!(ran.count("pixels") <= ran.count("fragments"));
}

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
fn parameters_that_do_not_fit_together_are_refused_with_a_key() {
    let refused = |settings: &[(&str, &str)], key: &str| {
        let config = config(settings);
        let problem = TextureMappingSystem::new(replay(&[], &config), &config).err().unwrap_or_else(|| panic!("{settings:?}"));
        assert_eq!(problem.key, key, "{problem}");
    };
    refused(&[("cache.texture.line_bytes", "48")], "cache.texture.line_bytes");
    refused(&[("cache.depth.line_bytes", "48")], "cache.depth.line_bytes");
    refused(&[("cache.depth.line_bytes", "32")], "cache.depth.line_bytes");
    refused(&[("memory.texture.outstanding", "8")], "memory.texture.outstanding");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases / 2, ..ProptestConfig::default() })]

    #[test]
    fn engines_agree_on_every_display_list_and_configuration(
        list in display_lists(), meaning in meanings(), timing in timings(),
    ) {
        let config = config(&[borrowed(&meaning), roomy(borrowed(&timing))].concat());
        agree(|| replay(&list, &config), &config);
    }

    #[test]
    fn law_6_times_never_change_a_picture(list in display_lists(), meaning in meanings(), timing in timings()) {
        let plain = config(&borrowed(&meaning));
        let (frames, _) = functional(replay(&list, &plain), &plain);
        prop_assert_eq!(timed(&list, &[borrowed(&meaning), roomy(borrowed(&timing))].concat()).frames, frames);
    }
}

/// With credits for a step whatever the lines of the cache.
fn roomy<'a>(mut settings: Vec<(&'a str, &'a str)>) -> Vec<(&'a str, &'a str)> {
    settings.push(("memory.texture.outstanding", "1024"));
    settings
}
