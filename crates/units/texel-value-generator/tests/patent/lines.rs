//! "The edge of an enlarged texel shows non-monotonicity; a smaller e cures it, a larger one makes it likelier."

use crate::chain::{config, textured, walk_on};
use crate::figures::scanned;
use basrelief_signals::WrapMode;
use basrelief_texel_value_generator::signals::ScanSpan;
use basrelief_texel_value_generator::{March, Method, Snap, TexelConfig};

/// Number of planes drawn.
const PLANES: usize = 300;
/// Edges between texels, evenly from the least to the largest u of a plane.
const EDGES: usize = 16;

/// Returns four numbers 0..1. All points fill their space evenly, because the factors are powers of the root of x^4 + x^5 = 1.
fn point(number: usize) -> [f64; 4] {
    let root = 1.167_303_978_261_418_7_f64.recip();
    let square = root * root;
    [root, square, square * root, square * square].map(|factor| (number as f64 * factor).fract())
}

/// Returns the scan lines of a plane that fills a picture of 64 x 64. W at its corners is 0.02 to 1, even in its logarithm, and u
/// is turned by any angle.
fn plane(number: usize) -> Vec<ScanSpan> {
    let [left, right, below, turn] = point(number);
    let w = |t: f64| libm::pow(0.02, t) as f32;
    let corners = [[0.0, 0.0, w(left)], [128.0, 0.0, w(right)], [0.0, 128.0, w(below)]];
    let (sin, cos) = libm::sincos(turn * std::f64::consts::TAU);
    let turned = |mut span: ScanSpan| {
        let [p, q] = span.scale.map(|n| 2f64.powi(n.into()));
        let of = |[u, v, w]: [f64; 3]| [0.125 * (cos * p * u + sin * q * v), 0.0, w];
        (span.ends, span.step, span.scale) = (span.ends.map(of), of(span.step), [3, 0]);
        span
    };
    scanned(Snap::Ceil, March::LeftToRight, &corners).0.into_iter().map(turned).collect()
}

/// Returns the number of times that an edge between texels reverses between scan lines. Exact edges are straight lines, and never
/// reverse.
fn reversals(spans: &[ScanSpan], config: &TexelConfig) -> usize {
    let polygon = textured(WrapMode::Clamp);
    let rows: Vec<Vec<f32>> =
        spans.iter().map(|s| walk_on(config, *s, &polygon, None).uv().iter().map(|uv| uv[0]).collect()).collect();
    let all = || rows.iter().flatten().copied();
    let (least, largest) = (all().fold(f32::MAX, f32::min), all().fold(f32::MIN, f32::max));
    let crossing = |row: &Vec<f32>, edge: f32| row.iter().position(|u| (*u > edge) != (row[0] > edge)).map(|k| k as i32);
    let turns = |edge: f32| {
        let columns: Vec<Option<i32>> = rows.iter().map(|row| crossing(row, edge)).collect();
        let moves = columns.windows(2).filter_map(|c| Some((c[1]? - c[0]?).signum()));
        let (up, down) = moves.fold((0, 0), |(up, down), m| (up + usize::from(m > 0), down + usize::from(m < 0)));
        up.min(down)
    };
    (1..=EDGES).map(|i| turns(least + (largest - least) * i as f32 / (EDGES + 1) as f32)).sum()
}

/// Returns the number of planes with a reversal, and of all reversals.
fn turning(config: &TexelConfig) -> (usize, usize) {
    let all: Vec<usize> = (0..PLANES).map(|number| reversals(&plane(number), config)).collect();
    (all.iter().filter(|n| **n > 0).count(), all.iter().sum())
}

// Claim: as texels_along_span_are_monotone.
#[test]
fn larger_e_gives_more_non_monotonic_texel_edges() {
    let exact = turning(&TexelConfig { method: Method::Exact, ..config(0.5) });
    let by_bound = [0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 4.0].map(|e| turning(&config(e)));
    assert_eq!(exact, (0, 0));
    assert_eq!(by_bound.map(|(planes, _)| planes), [0, 2, 3, 10, 18, 30, 36, 41], "{by_bound:?}");
}
