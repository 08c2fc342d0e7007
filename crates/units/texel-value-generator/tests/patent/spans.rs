//! Section 3: the step. Properties of division points along random scan lines.

use crate::chain::{Walked, bounds, config, rounding, span, spans, textured, walk, walk_on};
use basrelief_signals::WrapMode;
use basrelief_texel_value_generator::signals::ScanSpan;
use basrelief_texel_value_generator::{Method, RootTable, StepForm, TexelConfig, largest_displacement};
use proptest::prelude::*;

/// Returns the largest displacement between pixels `a` and `b` of the span by the formula, 0 between neighbours.
fn by_formula(span: &ScanSpan, a: u16, b: u16) -> f64 {
    let w = |k: u16| span.value(k)[2];
    if b - a <= 1 { 0.0 } else { largest_displacement(w(a), w(b), f64::from(b - a)) }
}

/// Returns the largest displacement by trial: for every share `t` of the way, the position at which the exact mapping is equally
/// far along the texture.
fn by_trial([a, b]: [f64; 2], length: f64) -> f64 {
    let exact_share = |t: f64| t * a / (b * (1.0 - t) + a * t);
    (0..=100_000).map(|i| f64::from(i) / 100_000.0).map(|t| length * (exact_share(t) - t).abs()).fold(0.0, f64::max)
}

// Claim: texel, the step: The largest displacement follows the derived formula, because the source lost the formula.
#[test]
fn section_3_largest_displacement_matches_formula() {
    for w in [[1.0, 2.0], [2.0, 1.0], [1.0, 1000.0], [1.0, 1.0], [0.3, 0.31]] {
        for length in [2.0, 16.0, 4096.0] {
            let (formula, trial) = (largest_displacement(w[0], w[1], length), by_trial(w, length));
            assert!((formula - trial).abs() <= 1e-4 * formula.max(1e-9), "{w:?} {length}: {formula} {trial}");
        }
    }
}

/// Returns the division points of the best scheme of a fixed interval that keeps e.
fn best_fixed(span: &ScanSpan, e: f64) -> usize {
    let last = span.last();
    let keeps = |k: u16| (0..last).step_by(usize::from(k)).all(|a| by_formula(span, a, (a + k).min(last)) <= e);
    // Longer intervals first, because a longer one never has more points.
    let k = (1..=last.max(1)).rev().find(|&k| keeps(k)).unwrap_or(1);
    (0..last).step_by(usize::from(k)).count().saturating_sub(1)
}

proptest! {
    // Claim: texel, the step: On random scan lines (w up to 1:1000, 1 to 4,096 pixels, e from 0.05 to 4) no pixel is displaced by
    // more than e, by formula and measured. No segment could be one pixel longer. No fixed interval within e has fewer divisions.
    // Steps change with w.
    #[test]
    fn section_3_displacement_is_at_most_e(span in spans(), e in bounds()) {
        let walked = walk(&config(e), span);
        for pair in walked.points().windows(2) {
            let displacement = by_formula(&span, pair[0], pair[1]);
            prop_assert!(displacement <= e + 1e-6, "{pair:?}: {displacement} by formula");
        }
        prop_assert!(walked.largest_displacement() <= e + rounding(&span), "{} measured", walked.largest_displacement());
    }

    // Claim: as section_3_displacement_is_at_most_e.
    #[test]
    fn section_3_segments_are_longest_possible(span in spans(), e in bounds()) {
        let points = walk(&config(e), span).points();
        for pair in points.windows(2).filter(|pair| pair[1] < span.last()) {
            let longer = largest_displacement(span.value(pair[0])[2], span.value(pair[1] + 1)[2], f64::from(pair[1] + 1 - pair[0]));
            prop_assert!(longer > e * (1.0 - 1e-9), "{pair:?} {longer}");
        }
    }

    // Claim: as section_3_displacement_is_at_most_e.
    #[test]
    fn section_3_fixed_interval_needs_no_fewer_divisions(
        span in spans().prop_filter("quadratic", |s| s.count <= 700), e in bounds(),
    ) {
        let inner = walk(&config(e), span).points().iter().filter(|k| **k > 0 && **k < span.last()).count();
        prop_assert!(inner <= best_fixed(&span, e), "{inner} {}", best_fixed(&span, e));
    }

    // Claim: as section_3_displacement_is_at_most_e.
    #[test]
    fn section_3_steps_grow_and_shrink_with_w(span in spans(), e in bounds()) {
        let points = walk(&config(e), span).points();
        let steps: Vec<i32> = points.windows(2).map(|p| i32::from(p[1] - p[0])).collect();
        let inner = &steps[..steps.len().saturating_sub(1)];
        let rises = span.ends[1][2] > span.ends[0][2];
        let monotone = inner.windows(2).all(|s| if rises { s[0] <= s[1] } else { s[0] >= s[1] });
        prop_assert!(monotone, "{steps:?}");
    }

    // Claim: texel, monotone: Texels are monotone along a span. A larger e makes edges of enlarged texels zigzag on more planes.
    #[test]
    fn texels_along_span_are_monotone(span in spans(), e in bounds()) {
        let uv = walk_on(&config(e), span, &textured(WrapMode::Clamp), None).uv();
        for i in 0..2 {
            let rising = span.ends[1][i] / span.ends[1][2] >= span.ends[0][i] / span.ends[0][2];
            let monotone = uv.windows(2).all(|p| if rising { p[0][i] <= p[1][i] } else { p[0][i] >= p[1][i] });
            prop_assert!(monotone);
        }
    }

    // Claim: texel, the step: A table in place of the square root keeps the bound, and costs divisions.
    #[test]
    fn root_table_keeps_bound_and_costs_divisions(span in spans(), e in bounds(), entries in 1u32..300) {
        let exact = walk(&config(e), span);
        let table = walk(&TexelConfig { step_table: entries, ..config(e) }, span);
        prop_assert!(table.largest_displacement() <= e + rounding(&span));
        prop_assert!(table.counters.segments >= exact.counters.segments);
    }

    // Claim: as figure_1_child_polygons_have_exact_ends.
    #[test]
    fn every_method_walks_each_pixel_once_in_order(
        span in spans(), e in bounds(), interval in 1u32..40, points in 0u32..9, backwards in any::<bool>(), x in 0u16..40,
        method in prop::sample::select(vec![Method::Adaptive, Method::Exact, Method::Fixed, Method::Subpolygon]),
    ) {
        let x = if backwards { x + span.count } else { x };
        let walked = walk(&TexelConfig { method, interval, points, ..config(e) }, ScanSpan { x, backwards, ..span });
        let mut columns: Vec<u16> =
            walked.packets.iter().flat_map(|s| s.packet.positions().map(|i| s.packet.x + i as u16).collect::<Vec<_>>()).collect();
        columns.sort_unstable();
        let first = if backwards { x - span.count + 1 } else { x };
        prop_assert_eq!(columns, (first..first + span.count).collect::<Vec<_>>());
        prop_assert_eq!(walked.counters.textured_pixels, u64::from(span.count));
        let points: u32 = walked.packets.iter().map(|s| s.points.count_ones()).sum();
        prop_assert_eq!(u64::from(points), walked.divider.state.counters.points, "each quotient is of a pixel");
        let ends = if span.count == 1 { 1 } else { 2 };
        prop_assert_eq!(walked.divider.state.counters.points, walked.counters.division_points + ends);
        prop_assert_eq!(walked.divider.state.counters.divisions, 2 * walked.divider.state.counters.points);
        if method == Method::Exact {
            prop_assert!(walked.largest_displacement() <= rounding(&span), "{} measured, {} by rounding", walked.largest_displacement(), rounding(&span));
        }
    }
}

// Claim: texel, the step: The approximate form keeps e for rising w. It exceeds e up to four times if w falls to zero.
#[test]
fn section_3_approximate_form_keeps_e_only_for_rising_w() {
    let ratio = |w: [f64; 2], e: f64| {
        let config = TexelConfig { step_form: StepForm::Approximate, ..config(e) };
        let span = span(2000, w, [[0.0, 0.0], [1.0, 0.0]]);
        let points = walk(&config, span).points();
        points.windows(2).map(|p| by_formula(&span, p[0], p[1])).fold(0.0, f64::max) / e
    };
    let (mut falling, mut rising) = (0.0f64, 0.0f64);
    // At 499.5, e |dw| / wl at the start is close to 1/4 if W falls to nothing.
    for e in [0.5, 4.0, 64.0, 256.0, 499.5] {
        for far in (1..60).map(|i| f64::from(i) / 60.0).chain([1e-9]) {
            falling = falling.max(ratio([1.0, far], e));
            rising = rising.max(ratio([far, 1.0], e));
        }
    }
    assert!(rising <= 1.0 + 1e-9, "{rising}");
    assert!((3.8..=4.0).contains(&falling), "{falling}");
    // At the bound recommended by the patent the ratio is close too, if W falls slowly.
    assert!(ratio([1.0, 0.5], 0.5) < 1.05);
}

// Claim: as figure_4a_step_410_snaps_ends_to_integer_pixels.
#[test]
fn short_and_degenerate_spans_are_handled() {
    let uv = [[0.0, 0.0], [3.0, 1.0]];
    for (count, w) in [(1, [1.0, 1.0]), (1, [0.2, 0.2]), (2, [1.0, 0.001]), (2, [0.001, 1.0]), (4096, [0.25, 0.25])] {
        let walked = walk(&config(0.5), span(count, w, uv));
        assert_eq!(walked.counters.division_points, 0, "{count} {w:?}");
        assert_eq!((walked.counters.segments, walked.counters.roots), (1, 0), "{count} {w:?}");
        assert!(walked.uv().iter().flatten().all(|c| c.is_finite()));
    }
    // W falls so fast that the bound holds to the end.
    let walked = walk(&config(4.0), span(9, [1.0, 1e-9], uv));
    assert!(walked.largest_displacement() <= 4.0);
}

// Claim: texel, formats: Rounding keeps the bound on spans of 4,096 pixels, with w up to 1:1000 and a thousand tiles.
#[test]
fn section_3_longest_spans_with_most_tiles_keep_e() {
    for w in [[1.0, 0.001], [0.001, 1.0], [1000.0, 1.0]] {
        for e in [0.05, 0.5, 4.0] {
            let span = span(4096, w, [[0.0, -500.0], [1000.0, 500.0]]);
            let walked = walk(&config(e), span);
            assert!(walked.largest_displacement() <= e + 1e-6, "{}", walked.largest_displacement());
            // The look-up table's input differs from u by whole tiles, and by the rounding to 24 bits of the tiles along a
            // packet.
            for packet in &walked.packets {
                let pixels: Vec<usize> = packet.packet.positions().collect();
                let length = pixels.iter().map(|&i| packet.uv[i][0].abs()).fold(2.0, f32::max);
                for &i in pixels.iter().filter(|i| packet.points & 1 << **i != 0) {
                    let [u, _] = Walked::exact(&span, packet.packet.x + i as u16);
                    let off = u - f64::from(packet.uv[i][0]);
                    assert!((off - 2.0 * (off / 2.0).round()).abs() <= f64::from(length) * 7e-8, "{off}");
                }
            }
        }
    }
}

// Claim: as root_table_keeps_bound_and_costs_divisions.
#[test]
fn table_roots_are_short_within_stated_error() {
    for entries in [1, 2, 64, 1024] {
        let table = RootTable::new(entries);
        for i in 1..4000 {
            let x = f64::from(i) * 0.37e-3 * f64::from(1u32 << (i % 31));
            let short = 1.0 - table.root(x) / x.sqrt();
            assert!((-1e-15..=table.largest_error() + 1e-12).contains(&short), "{entries} {x} {short}");
        }
        assert_eq!([0.0, -1.0, f64::NAN, f64::INFINITY].map(|x| table.root(x)), [0.0; 4]);
    }
    assert!(RootTable::new(64).largest_error() < 0.03);
}
