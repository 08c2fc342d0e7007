//! Letters made of strokes, for inscriptions in relief.

use glam::DVec2;

type LetterStroke = &'static [[f64; 2]];

/// Returns the strokes of a letter in a box of height 6, from the lower left. A letter that no inscription needs has no strokes.
fn strokes(letter: char) -> &'static [LetterStroke] {
    match letter {
        'A' => &[&[[0., 0.], [2., 6.], [4., 0.]], &[[0.7, 2.], [3.3, 2.]]],
        'B' => &[&[
            [0., 3.],
            [3., 3.],
            [3.7, 3.8],
            [3.7, 5.2],
            [3., 6.],
            [0., 6.],
            [0., 0.],
            [3., 0.],
            [4., 0.8],
            [4., 2.2],
            [3., 3.],
        ]],
        'E' => &[&[[4., 6.], [0., 6.], [0., 0.], [4., 0.]], &[[0., 3.], [3., 3.]]],
        'F' => &[&[[4., 6.], [0., 6.], [0., 0.]], &[[0., 3.], [3., 3.]]],
        'I' => &[&[[0., 0.], [0., 6.]]],
        'L' => &[&[[0., 6.], [0., 0.], [4., 0.]]],
        'R' => &[&[[0., 0.], [0., 6.], [3., 6.], [4., 5.2], [4., 3.8], [3., 3.], [0., 3.]], &[[2., 3.], [4., 0.]]],
        'S' => &[&[
            [4., 5.],
            [3., 6.],
            [1., 6.],
            [0., 5.],
            [0., 4.],
            [1., 3.],
            [3., 3.],
            [4., 2.],
            [4., 1.],
            [3., 0.],
            [1., 0.],
            [0., 1.],
        ]],
        _ => &[],
    }
}

/// Width of a letter's box.
pub(super) fn width(letter: char) -> f64 {
    if letter == 'I' { 0.0 } else { 4.0 }
}

/// Distance of a point of the letter's box to the nearest stroke.
pub(super) fn distance(letter: char, point: DVec2) -> f64 {
    let segments = strokes(letter).iter().flat_map(|stroke| stroke.windows(2));
    segments
        .filter_map(|s| s.first_chunk().map(|[a, b]| to_segment(point, (*a).into(), (*b).into())))
        .fold(f64::INFINITY, f64::min)
}

fn to_segment(point: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = ((point - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    point.distance(a + (b - a) * along)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_are_where_they_should_be() {
        assert_eq!(distance('I', DVec2::new(1.0, 3.0)), 1.0);
        assert_eq!(distance('L', DVec2::new(0.0, 5.0)), 0.0);
        assert_eq!(distance('?', DVec2::ZERO), f64::INFINITY);
    }
}
