//! Claims of the patent, and statements about the whole system.

use crate::common::covered_by_bump;
use crate::texel::recipe::{display_lists, frame, material, object, polygon, texture};
use crate::texel::runs::{Ran, config, figure, replay, run, scene_front, small_demo, timed};
use basrelief_kernel::Engine;
use basrelief_machines::texel::{FrameLog, TexelMachineConfig, TextureMappingSystem, warnings};
use basrelief_machines::{MachineEngines as _, PictureMachine};
use basrelief_signals::{Control, WrapMode};
use proptest::prelude::*;

/// A floor that runs from near to far, as wide as the picture.
fn floor(size: [u32; 2], w: [f32; 2], tiles: f32) -> Vec<Control> {
    let [width, height] = size.map(|side| side as f32);
    let corners = [[0.0, 0.0, 0.5, w[0]], [width, 0.0, 0.5, w[1]], [width, height, 0.5, w[1]], [0.0, height, 0.5, w[0]]];
    let uv = [[0.0, 0.0], [tiles, 0.0], [tiles, 1.0], [0.0, 1.0]];
    let material = material(Some(texture(WrapMode::Repeat)));
    vec![frame(0, size), object(0), polygon(&corners, &uv, &material, false), Control::FrameEnd]
}

fn log_of(list: &[Control], config: &TexelMachineConfig) -> FrameLog {
    let mut machine = TextureMappingSystem::new(replay(list, config), config).unwrap();
    machine.keep_log();
    machine.run_functional(&mut |_| true).unwrap();
    machine.drain_finished();
    machine.drain_logs(1).remove(0)
}

fn starved(ran: &Ran, unit: &str, input: &str) -> u64 {
    let unit = ran.report.units.iter().find(|u| u.name == unit).expect("wired");
    let at = unit.inputs.iter().position(|i| i == input).expect("an input");
    unit.account.starved[at]
}

// Claim: texel, 1 to 3: Each scan line has division points and is interpolated between them. Only ends and division points are
// exact.
#[test]
fn claims_1_to_3_points_between_divisions_are_approximated() {
    let list = floor([400, 8], [1.0, 0.02], 3.0);
    let log = log_of(&list, &config(&[("pixel_value_buffer.depth_test", "false")]));
    let mut inner = 0;
    for span in &log.spans {
        inner += span.divisions.len();
        assert!(span.divisions.iter().all(|x| span.x[0] < *x && *x < span.x[1]), "{span:?}");
        assert!(span.divisions.windows(2).all(|d| d[0] < d[1]), "{span:?}");
        let place = |x: u16| usize::from(span.y) * 400 + usize::from(x);
        let exact: Vec<u16> = (span.x[0]..=span.x[1]).filter(|x| log.map.divided[place(*x)]).collect();
        let expected: Vec<u16> = [&span.x[..1], &span.divisions, &span.x[1..]].concat();
        assert_eq!(
            exact,
            {
                let mut e = expected;
                e.dedup();
                e
            },
            "exact at ends and division points, nowhere else"
        );
        assert!(exact.iter().all(|x| log.map.displacement[place(*x)] < 1e-3), "claim 3: exactly, but for rounding");
        assert!((span.x[0]..=span.x[1]).all(|x| log.map.displacement[place(x)] <= 0.5 + 1e-6));
    }
    assert!(inner > 20, "{inner}");
}

// Claim: texel, 4, 7: The texel modifies the pixel value, with illuminance and the old value.
#[test]
fn claims_4_and_7_intermediate_texel_modifies_pixel_value() {
    let list = floor([64, 8], [1.0, 0.1], 2.0);
    let plain = timed(&list, &[("illuminance.mode", "off")]);
    let lit = timed(&list, &[]);
    assert_ne!(plain.frames[0].rgb, lit.frames[0].rgb);
    // Drawn twice and blended: the second time over the first.
    let twice = [&list[..3], &list[2..3], &list[3..]].concat();
    let off = ("pixel_value_buffer.depth_test", "false");
    let blended = timed(&twice, &[("combiner.mode", "blend"), off]);
    let once = timed(&list, &[("combiner.mode", "blend"), off]);
    assert_eq!(blended.count("pixels_read_back"), 2 * 64 * 8);
    let sum = |ran: &Ran| ran.frames[0].rgb.iter().flatten().map(|c| u64::from(*c)).sum::<u64>();
    assert!(sum(&blended) > sum(&once) && sum(&once) > 0);
}

// Claim: texel, 5, 6: The step calculator uses the criterion in its storage element: a larger e gives fewer points.
#[test]
fn claims_5_and_6_steps_follow_the_stored_criterion() {
    let list = floor([400, 8], [1.0, 0.02], 3.0);
    let mut before = u64::MAX;
    for e in ["0.05", "0.1", "0.5", "1", "4"] {
        let ran = timed(&list, &[("texel.error_bound", e)]);
        assert_eq!(figure(&ran.facts, "displacement_bound").to_string(), e);
        assert!(figure(&ran.facts, "displacement_largest") <= e.parse::<f64>().unwrap() + 1e-6);
        assert!(ran.count("division_points") < before, "a larger e needs fewer points");
        before = ran.count("division_points");
    }
}

// Claim: texel, 7, 8: Step calculator, approximate calculator, combiner and storage element in one system.
#[test]
fn claim_8_system_has_all_four_elements() {
    let ran = timed(&floor([64, 8], [1.0, 0.1], 2.0), &[]);
    for unit in ["step-calculator", "approximate-calculator", "combiner"] {
        assert!(ran.report.units.iter().any(|u| u.name == unit));
    }
    let tokens = |name: &str| ran.report.fifos.iter().find(|f| f.name == name).map_or(0, |f| f.tokens);
    assert!(tokens("segments") > 0 && tokens("texture_values") > 0 && tokens("pixels") > 0);
}

// Claim: as claim_9_level_is_constant_per_segment.
#[test]
fn claim_9_the_pixel_value_follows_the_level_of_the_segment() {
    let list = floor([64, 8], [1.0, 0.02], 60.0);
    let level_0 = timed(&list, &[]);
    for mode in ["nearest", "trilinear"] {
        let ran = timed(&list, &[("mip.mode", mode)]);
        assert_ne!(ran.frames[0].rgb, level_0.frames[0].rgb);
        assert!(ran.count("mip_selections") >= ran.count("segments"));
        assert!(ran.count("gradient_reciprocals") == 0);
    }
}

// Claim: texel, timing: A pipelined divider hides its latency. An iterative one starves the interpolator at a small e. Each method
// counts its divisions.
#[test]
fn section_5_iterative_divider_starves_the_interpolator() {
    let list = floor([640, 32], [1.0, 0.02], 3.0);
    let starved = |settings: &[(&str, &str)]| starved(&timed(&list, settings), "approximate-calculator", "quotients");
    let one = ("divider.count", "1");
    let tight = ("texel.error_bound", "0.05");
    let iterative = starved(&[one, tight]);
    let fast = [("texel.step_table", "1024"), ("operators.multiply.latency", "1"), ("operators.add.latency", "1")];
    let pipelined = starved(&[&[one, tight, ("divider.pipelined", "true")], &fast[..]].concat());
    assert!(iterative > 10 * pipelined.max(1), "{iterative} {pipelined}");
    let loose = starved(&[("texel.error_bound", "2")]);
    assert!(loose < iterative / 10, "{loose}: segments are longer than a division takes");
}

// Claim: as section_5_iterative_divider_starves_the_interpolator.
#[test]
fn section_6_divisions_per_pixel_of_the_methods() {
    let list = floor([640, 16], [1.0, 0.1], 3.0);
    let split = |ran: &Ran, name: &str| figure(&ran.facts, &format!("divisions_of_{name}"));
    let ran = |settings: &[(&str, &str)]| {
        let ran = timed(&list, settings);
        let parts = ["span_ends", "points", "exact_pixels", "steps", "gradients", "setup"].map(|name| split(&ran, name));
        assert!((parts.iter().sum::<f64>() - figure(&ran.facts, "divisions_per_pixel")).abs() < 1e-12, "{parts:?}");
        let [ends, points, exact, ..] = parts;
        (ends + points + exact, figure(&ran.facts, "displacement_largest"))
    };
    assert_eq!(ran(&[("texel.method", "exact")]).0, 2.0);
    assert_eq!(ran(&[("texel.method", "exact"), ("divider.division", "reciprocal")]).0, 1.0);
    let adaptive = ran(&[]);
    assert!(adaptive.1 <= 0.5 + 1e-6);
    for interval in ["4", "8", "16", "32"] {
        let fixed = ran(&[("texel.method", "fixed"), ("texel.interval", interval)]);
        assert!(fixed.0 > adaptive.0 || fixed.1 > adaptive.1, "{interval}: {fixed:?} {adaptive:?}");
        let children = ran(&[("texel.method", "subpolygon"), ("texel.interval", interval)]);
        assert!(children.0 > fixed.0, "child polygons share no end: {children:?} {fixed:?}");
    }
}

// Claim: as section_5_iterative_divider_starves_the_interpolator.
#[test]
fn section_6_divisions_are_counted_by_unit() {
    let list = floor([640, 16], [1.0, 0.1], 3.0);
    let of = |settings: &[(&str, &str)]| {
        let ran = timed(&list, settings);
        let per_pixel = |name: &str| figure(&ran.facts, &format!("divisions_of_{name}"));
        let all = figure(&ran.facts, "divisions_per_pixel");
        (
            ["span_ends", "points", "exact_pixels", "steps", "gradients", "setup"].map(|n| (per_pixel(n) * 640.0 * 16.0).round()),
            all,
            ran,
        )
    };
    let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
    // Two triangles: 32 spans but for a row where one of them has no pixel; each end is two divisions.
    let ([ends, points, exact, steps, gradients, setup], all, ran) = of(&[]);
    let spans = (ran.count("spans") - ran.count("spans_of_one_pixel")) as f64;
    assert_eq!(ends, 2.0 * (2.0 * spans + ran.count("spans_of_one_pixel") as f64));
    assert_eq!((points, steps), (2.0 * ran.count("division_points") as f64, ran.count("step_divisions") as f64));
    assert_eq!((exact, gradients, setup), (0.0, 0.0, 2.0 * 4.0), "three slopes and an area for each triangle");
    assert!(steps > 0.0 && near(all * 640.0 * 16.0, ends + points + steps + setup));
    let ([ends, points, exact, steps, gradients, setup], all, _) = of(&[("texel.method", "exact"), ("mip.mode", "nearest")]);
    assert_eq!((ends + exact, points, steps, gradients, setup), (2.0 * 640.0 * 16.0, 0.0, 0.0, 640.0 * 16.0, 8.0));
    assert!(near(all, 3.0 + 8.0 / (640.0 * 16.0)));
}

// Claim: texel, 6, 8: A trace selects the criterion of a frame and of an object.
#[test]
fn claims_6_and_8_trace_sets_criterion_of_frame_and_object() {
    let plain = floor([400, 8], [1.0, 0.02], 3.0);
    let selecting = |at: usize, e: f64| [&plain[..at], &[Control::Criterion(e)], &plain[at..]].concat();
    let points = |list: &[Control], e: &str| timed(list, &[("texel.error_bound", e)]).count("division_points");
    // After the frame and after the object, the criterion has the same effect as a configured one.
    for at in [1, 2] {
        assert_eq!(points(&selecting(at, 0.1), "0.5"), points(&plain, "0.1"));
        assert_eq!(figure(&timed(&selecting(at, 2.0), &[]).facts, "displacement_bound"), 2.0);
    }
    // Two objects with different criteria. The last criterion stays in effect in the next frame.
    let other = |e: f64| [object(1), Control::Criterion(e), plain[2].clone()];
    let both = [&selecting(1, 0.1)[..4], &other(2.0)[..], &plain[3..]].concat();
    let mut next = plain.clone();
    next[0] = frame(1, [400, 8]);
    let off = ("pixel_value_buffer.depth_test", "false");
    let of = |list: &[Control]| timed(list, &[off]).count("division_points");
    let (fine, coarse) = (points(&plain, "0.1"), points(&plain, "2"));
    assert!(fine > coarse);
    assert_eq!(of(&both), fine + coarse);
    assert_eq!(of(&[both, next].concat()), fine + 2 * coarse);
}

// Claim: as section_5_first_step_takes_division_and_root.
#[test]
fn trilinear_pixel_takes_twice_the_time_of_a_bilinear_one() {
    // Every pixel lies between two levels: 1.4 texels of the 16 per pixel.
    let list = floor([640, 8], [1.0, 1.0], 56.0);
    let memory = [("memory.texture.part", "ideal"), ("memory.pixel.part", "ideal"), ("memory.depth.part", "ideal")];
    let busy = |settings: &[(&str, &str)]| {
        let ran = timed(&list, &[&memory[..], &[("cache.texture.lookups_per_cycle", "16")], settings].concat());
        let unit = ran.report.units.iter().find(|u| u.name == "texture-look-up").expect("wired");
        (unit.account.busy as f64 / (640.0 * 8.0), ran.count("samples_filtered") / (640 * 8))
    };
    let near = |(cycles, samples): (f64, u64), expected: u64| samples == expected && (cycles - expected as f64).abs() < 0.01;
    assert!(near(busy(&[]), 1) && near(busy(&[("mip.mode", "nearest")]), 1));
    assert!(near(busy(&[("mip.mode", "trilinear")]), 2), "{:?}", busy(&[("mip.mode", "trilinear")]));
    let (cycles, samples) = busy(&[("mip.mode", "trilinear"), ("look_up.samples_per_cycle", "2")]);
    assert!(cycles < 1.01 && samples == 2, "two filters: {cycles}");
}

// Claim: as coverage_is_that_of_the_rasterizer_by_every_method.
#[test]
fn log_changes_nothing_and_contains_all_spans() {
    let scene = small_demo("corridor");
    let config = config(&[]);
    let mut machine = TextureMappingSystem::new(scene_front(&scene, &config), &config).unwrap();
    machine.keep_log();
    let report = machine.run(Engine::Timed);
    let plain = run(scene_front(&scene, &config), &config, Engine::Timed);
    assert!(report == plain.report && machine.facts() == plain.facts && machine.drain_finished() == plain.frames);
    let log = machine.drain_logs(1).remove(0);
    let pixels: u64 = log.spans.iter().map(|s| u64::from(s.x[1] - s.x[0] + 1)).sum();
    assert_eq!(pixels, plain.count("textured_fragments"));
    let points: u64 = log.spans.iter().map(|s| s.divisions.len() as u64).sum();
    assert_eq!(points, plain.count("division_points"));
    assert!(log.spans.iter().all(|s| s.w.iter().all(|w| *w > 0.0)));
    assert_eq!((log.map.width, log.map.height, log.map.displacement.len()), (64, 48, 64 * 48));
    let largest = log.map.displacement.iter().filter(|d| !d.is_nan()).fold(0.0f32, |a, b| a.max(*b));
    assert!(f64::from(largest) <= figure(&plain.facts, "displacement_largest") + 1e-6 && largest > 0.0);
}

#[test]
fn span_record_matches_its_scan_line() {
    let list = floor([40, 1], [1.0, 0.02], 3.0);
    let log = log_of(&list, &config(&[]));
    let line = serde_json::to_string(&log.spans[0]).unwrap();
    assert!(line.starts_with("{\"y\":0,\"x\":[") && line.contains("\"w\":[") && line.contains("\"divisions\":["), "{line}");
}

#[test]
fn unused_input_is_a_warning() {
    let mut list = floor([40, 8], [1.0, 0.1], 1.0);
    let warned = |list: &[Control], settings: &[(&str, &str)]| warnings(&config(settings), &timed(list, settings).facts);
    assert_eq!(warned(&list, &[]), [""; 0], "defaults hold full rate");
    let short = warned(&list, &[("fifo.texels.depth", "2")]);
    assert!(short.len() == 1 && short[0].contains("fifo.texels.depth = 2"), "{short:?}");
    assert_eq!(
        warned(&list, &[("look_up.filter_latency", "9"), ("combiner.blend_latency", "4")]),
        [
            "look_up.filter_latency = 9 counts as 6, because it is a part of look_up.latency = 6",
            "combiner.blend_latency = 4 counts as 3, because it is a part of combiner.latency = 3",
        ]
    );
    list[2] =
        polygon(&[[1.0, 1.0, 0.5, 1.0], [30.0, 1.0, 0.5, 1.0], [1.0, 8.0, 0.5, 1.0]], &[[0.0; 2]; 3], &material(None), false);
    let ran = timed(&list, &[]);
    assert!(warnings(&config(&[]), &ran.facts)[0].contains("no polygon has a colour texture"));
    assert_eq!((ran.count("divisions"), ran.count("texels_read")), (0, 0));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases / 2, ..ProptestConfig::default() })]

    // Claim: texel, coverage, log: Every method covers the rasterizer's pixels. A log of spans and displacements changes nothing.
    #[test]
    fn coverage_is_that_of_the_rasterizer_by_every_method(
        list in display_lists(), method in prop::sample::select(vec!["adaptive", "exact", "fixed", "subpolygon"]),
    ) {
        let ran = timed(&list, &[("texel.method", method)]);
        prop_assert_eq!(ran.frames.iter().map(|f| f.covered.clone()).collect::<Vec<_>>(), covered_by_bump(&list));
    }

    // Claim: as section_3_displacement_is_at_most_e.
    #[test]
    fn no_pixel_is_displaced_by_more_than_e(list in display_lists()) {
        let list: Vec<Control> = list.into_iter().filter(|c| !matches!(c, Control::Criterion(_))).collect();
        for e in ["0.05", "0.5", "4"] {
            // The maximum number of bits, so that the remaining error is that of the criterion.
            let ran = timed(&list, &[("texel.error_bound", e), ("texel.coordinate_bits", "44")]);
            prop_assert!(figure(&ran.facts, "displacement_largest") <= e.parse::<f64>().unwrap() + 1e-4);
        }
    }
}
