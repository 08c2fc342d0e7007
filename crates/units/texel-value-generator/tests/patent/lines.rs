//! "The edge of an enlarged texel shows non-monotonicity; a smaller e cures it, a larger one makes it likelier."

use crate::chain::{config, walk};
use crate::figures::scanned;
use basrelief_texel_value_generator::{March, Snap};

/// Columns at which u passes an edge between enlarged texels, scan line by scan line, on a plane that runs away to the right
/// and downwards: the exact ones fall, each edge being a straight line.
fn reversals(e: f64) -> u32 {
    let corners = [[0.0, 0.0, 1.0], [64.0, 0.0, 0.05], [0.0, 64.0, 0.4]];
    let (spans, _) = scanned(Snap::Ceil, March::LeftToRight, &corners);
    let rows: Vec<Vec<f32>> = spans.iter().map(|span| walk(&config(e), *span).uv().iter().map(|uv| uv[0]).collect()).collect();
    let crossing = |row: &[f32], edge: f32| row.iter().position(|u| *u > edge).map(|k| k as i32);
    let mut reversed = 0;
    for edge in (1..60).map(|i| i as f32 / 64.0) {
        let columns: Vec<i32> = rows.iter().map_while(|row| crossing(row, edge)).collect();
        let moves: Vec<i32> = columns.windows(2).map(|c| c[1] - c[0]).collect();
        let (up, down) = (moves.iter().filter(|m| **m > 0).count(), moves.iter().filter(|m| **m < 0).count());
        reversed += up.min(down) as u32;
    }
    reversed
}

#[test]
fn edges_of_enlarged_texels_are_monotone_at_a_small_e_and_not_at_a_large_one() {
    let by_bound: Vec<(f64, u32)> = [0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 4.0].into_iter().map(|e| (e, reversals(e))).collect();
    // On this plane it begins between 1 and 2 pixels.
    assert!(by_bound.iter().all(|(e, n)| (*n > 0) == (*e >= 2.0)), "{by_bound:?}");
    assert!(by_bound[6].1 > 4 * by_bound[5].1, "{by_bound:?}");
}
