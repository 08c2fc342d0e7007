//! Figures 1, 2, 4A, 4B and 6 step by step, and the dividers.

use crate::chain::{Walked, config, operators, span, textured, walk};
use basrelief_kernel::{Demand, MemoryPorts, Unit};
use basrelief_signals::{Control, Flow, Frame, Polygon, Vertex, WrapMode};
use basrelief_texel_value_generator::signals::{DivisionPoint, DivisionPoints, FixedCoordinates, ScanSpan};
use basrelief_texel_value_generator::{
    Divider, DividerConfig, DividerCounters, Division, March, Method, ScanConverter, ScanConverterConfig, Snap, StorageElement,
    TexelConfig,
};
use smallvec::smallvec;
use std::sync::Arc;

pub fn frame(width: u32, height: u32) -> Control {
    Control::Frame(Arc::new(Frame { width, height, ..Frame::default() }))
}

/// Creates a textured polygon of corners (x, y, 1 / w), with u and v as x and y over the size of a picture of 64 x 64.
pub fn polygon(corners: &[[f32; 3]]) -> Control {
    let vertex = |&[x, y, w]: &[f32; 3]| Vertex { position: [x, y, 0.5, w], uv: [x / 64.0, y / 64.0], ..Vertex::default() };
    let polygon = Polygon { vertices: corners.iter().map(vertex).collect(), ..Polygon::clone(&textured(WrapMode::Repeat)) };
    Control::Polygon(Arc::new(polygon))
}

/// Returns the spans of a polygon.
pub fn scanned(snap: Snap, march: March, corners: &[[f32; 3]]) -> (Vec<ScanSpan>, ScanConverter) {
    let mut unit = ScanConverter::new(ScanConverterConfig::default(), snap, march, operators());
    unit.step(Some(frame(64, 64)), &mut MemoryPorts::default());
    unit.step(Some(polygon(corners)), &mut MemoryPorts::default());
    let mut spans = Vec::new();
    while unit.demand() == Demand::Nothing {
        let (Some(Flow::Item(span)), Some(Flow::Item(lit))) = unit.step(None, &mut MemoryPorts::default()).out else { panic!() };
        assert_eq!((span.x, span.y, span.count), (lit.x, lit.y, lit.count));
        spans.push(span);
    }
    (spans, unit)
}

// Claim: texel, Figure 4A: Ends are snapped (410). Empty spans are dropped (420). Short spans have ends only (430).
#[test]
fn figure_4a_step_410_snaps_ends_to_integer_pixels() {
    let bar = [[3.25, 5.0, 1.0], [9.75, 5.0, 1.0], [9.75, 6.0, 1.0], [3.25, 6.0, 1.0]];
    let columns = |snap| {
        let (spans, _) = scanned(snap, March::LeftToRight, &bar);
        let mut all: Vec<u16> = spans.iter().flat_map(|s| (0..s.count).map(|k| s.column(k))).collect();
        all.sort_unstable();
        (all.first().copied(), all.last().copied(), all.len())
    };
    // The ends are 2.75 and 9.25, counted from the centre of the first pixel. The right one belongs to the next polygon.
    assert_eq!(columns(Snap::Ceil), (Some(3), Some(9), 7));
    assert_eq!(columns(Snap::Round), (Some(3), Some(8), 6));
    assert_eq!(columns(Snap::Floor), (Some(2), Some(8), 7));
    assert_eq!(columns(Snap::Truncate), columns(Snap::Floor));
}

// Claim: as figure_4a_step_410_snaps_ends_to_integer_pixels.
#[test]
fn figure_4a_step_420_drops_empty_span() {
    let sliver = [[3.6, 0.0, 1.0], [4.4, 0.0, 1.0], [4.4, 9.0, 1.0], [3.6, 9.0, 1.0]];
    let (spans, unit) = scanned(Snap::Ceil, March::LeftToRight, &sliver);
    assert!(spans.is_empty() && unit.state.counters.empty == 1);
}

// Claim: as figure_4a_step_410_snaps_ends_to_integer_pixels.
#[test]
fn figure_4a_step_430_short_span_has_only_end_points() {
    let uv = [[0.0, 0.0], [1.0, 0.0]];
    for (count, min_span, short) in [(20, 20, true), (21, 20, false), (2, 2, true), (4, 2, false), (400, 1000, true)] {
        let walked = walk(&TexelConfig { min_span, ..config(0.05) }, span(count, [1.0, 0.1], uv));
        assert_eq!((walked.counters.short == 1, walked.counters.division_points == 0), (short, short), "{count}");
        assert_eq!(walked.counters.step_divisions, u64::from(!short));
    }
}

// Claim: texel, Figure 4B: The step is rounded down, at least 1, at most the rest (444, 446). Both directions keep the bound.
#[test]
fn figure_4b_next_point_is_step_rounded_down_and_clamped() {
    let span = span(300, [0.1, 1.0], [[0.0, 0.0], [1.0, 0.0]]);
    for e in [0.01, 0.5, 3.0] {
        let dw = span.step[2];
        for pair in walk(&config(e), span).points().windows(2) {
            let t = 2.0 * (e * span.value(pair[0])[2] / dw).sqrt() + e;
            let left = f64::from(span.last() - pair[0]);
            assert_eq!(f64::from(pair[1] - pair[0]), t.floor().max(1.0).min(left));
        }
    }
}

// Claim: as claims_1_to_3_points_between_divisions_are_approximated.
#[test]
fn figure_6_division_points_are_exact_rest_is_linear() {
    let span = span(200, [1.0, 0.05], [[0.2, 0.9], [0.7, 0.1]]);
    let walked = walk(&config(0.5), span);
    let uv = walked.uv();
    let exact = |k: u16| Walked::exact(&span, k);
    let is = |got: [f32; 2], expected: [f64; 2]| (0..2).all(|i| (f64::from(got[i]) - expected[i]).abs() < 1e-7);
    assert!(walked.points().len() > 4);
    for pair in walked.points().windows(2) {
        let [from, to] = [exact(pair[0]), exact(pair[1])];
        for k in pair[0]..=pair[1] {
            let share = f64::from(k - pair[0]) / f64::from(pair[1] - pair[0]);
            assert!(is(uv[usize::from(k)], std::array::from_fn(|i| from[i] + share * (to[i] - from[i]))), "{k}");
        }
    }
}

// Claim: as figure_1_child_polygons_have_exact_ends.
#[test]
fn figure_2_fixed_points_and_intervals_divide_span() {
    let span = span(65, [1.0, 0.5], [[0.0, 0.0], [1.0, 0.0]]);
    let fixed = |points, interval| walk(&TexelConfig { method: Method::Fixed, points, interval, ..config(0.5) }, span).points();
    assert_eq!(fixed(7, 1), [0, 8, 16, 24, 32, 40, 48, 56, 64]);
    assert_eq!(fixed(2, 1), [0, 21, 43, 64]);
    assert_eq!(fixed(1000, 1).len(), 65, "no more than pixels");
    assert_eq!(fixed(0, 30), [0, 30, 60, 64]);
    assert_eq!(fixed(0, 64), [0, 64]);
}

// Claim: texel, Figures 1, 2: Child polygons have exact ends on each scan line; fixed points lie evenly.
#[test]
fn figure_1_child_polygons_have_exact_ends() {
    // A triangle of 40 pixels, cut into 4 x 4 of 10. On its scan lines the lines between them are 10 pixels apart.
    let corners = [[0.5, 0.5, 1.0], [40.5, 0.5, 0.5], [0.5, 40.5, 0.25]];
    let (spans, _) = scanned(Snap::Ceil, March::LeftToRight, &corners);
    assert_eq!(spans.len(), 40);
    // The longest edge is the diagonal: 56.6 pixels.
    let config = TexelConfig { method: Method::Subpolygon, interval: 15, ..TexelConfig::default() };
    let Control::Polygon(polygon) = polygon(&corners) else { unreachable!() };
    for span in &spans {
        let walked = crate::chain::walk_on(&config, *span, &polygon, None);
        // Children are 10 pixels wide, and a scan line crosses some pointing up and some pointing down.
        assert!(walked.segments.iter().all(|s| s.walk <= 11), "{:?}", span.y);
        assert!(walked.segments.windows(2).all(|s| s[1].from == s[0].to + 1));
        let ends: u64 = walked.segments.iter().map(|s| if s.from == s.to { 1 } else { 2 }).sum();
        assert_eq!(walked.divider.state.counters.points, ends);
    }
}

// Claim: as figure_4b_next_point_is_step_rounded_down_and_clamped.
#[test]
fn right_to_left_marching_keeps_same_bound() {
    let corners = [[2.5, 3.0, 1.0], [60.5, 3.0, 0.05], [60.5, 40.0, 0.05], [2.5, 40.0, 1.0]];
    let (left, _) = scanned(Snap::Ceil, March::LeftToRight, &corners);
    let (right, _) = scanned(Snap::Ceil, March::RightToLeft, &corners);
    assert_eq!(left.len(), right.len());
    for (a, b) in left.iter().zip(&right) {
        assert_eq!((a.column(0), a.column(a.last()), a.ends), (b.column(b.last()), b.column(0), [b.ends[1], b.ends[0]]));
        let [a, b] = [a, b].map(|span| walk(&config(0.3), *span));
        assert!(b.largest_displacement() <= 0.3 + 1e-6);
        assert!(a.points().len().abs_diff(b.points().len()) <= 1);
    }
}

// Claim: texel, w > 0: A w of 0 or less is an error with its place.
#[test]
fn non_positive_w_error_names_place() {
    for w in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let mut unit = ScanConverter::default();
        let mut traffic = MemoryPorts::default();
        unit.step(Some(frame(8, 8)), &mut traffic);
        unit.step(Some(polygon(&[[0.0, 0.0, 1.0], [8.0, 0.0, w], [0.0, 8.0, 1.0]])), &mut traffic);
        let said = format!("{traffic:?}");
        assert!(said.contains("object 0 has 1 / w =") && said.contains("near plane"), "{said}");
        assert!(unit.is_empty());
    }
}

// Claim: as reciprocal_division_matches_two_divisions.
#[test]
fn free_divider_takes_next_division() {
    let cycles = |count, pipelined, bits, divisions| {
        let config = DividerConfig { count, pipelined, ..DividerConfig::default() };
        Divider::new(config, bits, operators()).cycles(divisions)
    };
    // Occupancy, and latency to the last quotient.
    assert_eq!(cycles(1, false, 32, 2), (32, 32));
    assert_eq!(cycles(2, false, 32, 2), (16, 16));
    assert_eq!(cycles(4, false, 32, 2), (8, 16));
    assert_eq!(cycles(1, true, 32, 2), (2, 17));
    assert_eq!(cycles(2, true, 32, 4), (2, 17));
    assert_eq!(cycles(3, false, 20, 4), (14, 20));
}

/// Returns the quotients of some points, the occupancy and latency of the dividers, and the counters.
fn divided(config: DividerConfig, bits: u32, points: &DivisionPoints) -> (Vec<[i64; 2]>, u64, u64, DividerCounters) {
    let mut unit = Divider::new(config, bits, operators());
    let step = unit.step(Some(Flow::Item(points.clone())), &mut MemoryPorts::default());
    let Some(Flow::Item(quotients)) = step.out else { panic!() };
    (quotients.iter().map(|FixedCoordinates(uv)| *uv).collect(), step.occupancy, step.latency, unit.state.counters)
}

// Claim: texel, width: A quotient of w bits takes w / 2 cycles. The default is the narrowest width within the bound on the demos.
#[test]
fn division_takes_half_its_quotient_bits_in_cycles() {
    let points = smallvec![DivisionPoint([0.5, 0.25, 0.9])];
    let kept = |bits, bits_per_cycle| {
        let (_, occupancy, latency, _) = divided(DividerConfig { bits_per_cycle, ..DividerConfig::default() }, bits, &points);
        assert_eq!(occupancy, latency, "two divisions on two dividers");
        occupancy
    };
    assert_eq!([12, 24, 29, 32, 48].map(|bits| kept(bits, 2)), [6, 12, 15, 16, 24], "radix 4");
    assert_eq!([24, 29].map(|bits| kept(bits, 1)), [24, 29], "radix 2");
}

// Claim: as division_takes_half_its_quotient_bits_in_cycles.
#[test]
fn quotients_are_rounded_to_coordinate_bits() {
    let points = smallvec![DivisionPoint([1.0, -2.0, 3.0])];
    for bits in [12, 20, 48] {
        let (quotients, ..) = divided(DividerConfig::default(), bits, &points);
        let one = (1i64 << (bits - 1)) as f64;
        assert_eq!(quotients, [[(one / 3.0).round() as i64, (-one * 2.0 / 3.0).round() as i64]]);
    }
}

// Claim: texel, two divisions: A point takes two divisions, or a reciprocal and two multiplications. Dividers differ by count,
// latency and interval.
#[test]
fn reciprocal_division_matches_two_divisions() {
    let points: DivisionPoints = smallvec![DivisionPoint([0.4, 0.45, 0.5]), DivisionPoint([0.3, 0.1, 0.7])];
    let of = |division| divided(DividerConfig { division, ..DividerConfig::default() }, 32, &points);
    let (two, occupancy, latency, counters) = of(Division::Two);
    assert_eq!((occupancy, latency, counters.divisions, counters.reciprocals, counters.multiplications), (32, 32, 4, 0, 0));
    let (one, occupancy, latency, counters) = of(Division::Reciprocal);
    assert_eq!((occupancy, latency, counters.divisions, counters.reciprocals, counters.multiplications), (16, 16 + 3, 0, 2, 4));
    // The rounding of the reciprocal moves a product by half a step at most, and the product itself is rounded.
    assert!(two.iter().flatten().zip(one.iter().flatten()).all(|(a, b)| (a - b).abs() <= 1), "{two:?} {one:?}");
}

// Claim: as claims_5_and_6_steps_follow_the_stored_criterion.
#[test]
fn storage_element_holds_criterion_until_next() {
    let mut storage = StorageElement::default();
    storage.select(0.5);
    assert_eq!(storage.criterion(), 0.5);
    storage.select(2.0);
    storage.select(1.0);
    assert_eq!((storage.criterion(), storage.largest, storage.selected), (1.0, 2.0, 3));
}
