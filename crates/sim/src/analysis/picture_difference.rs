//! Difference of two pictures in 8-bit steps.

use basrelief_reference::RgbPicture;
use basrelief_report::model::Difference;

/// Returns the mean and the largest difference of the 8-bit values, over pixels that are covered in either picture. The pictures must
/// have the same size.
pub(crate) fn difference(exact: &RgbPicture, other: &RgbPicture) -> Difference {
    let (mut sum, mut values, mut largest) = (0_u64, 0_u64, 0);
    let covered = exact.covered.iter().zip(&other.covered).map(|(a, b)| *a || *b);
    for (_, (a, b)) in covered.zip(exact.rgb.iter().zip(&other.rgb)).filter(|(covered, _)| *covered) {
        for (a, b) in a.iter().zip(b) {
            let step = a.abs_diff(*b);
            (sum, values, largest) = (sum + u64::from(step), values + 1, step.max(largest));
        }
    }
    let mean = if values == 0 { 0.0 } else { basrelief_report::number::round6(sum as f64 / values as f64) };
    Difference { mean, largest }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_covered_pixels_count() {
        let mut exact = RgbPicture::new(2, 2);
        let mut other = exact.clone();
        assert_eq!(difference(&exact, &other), Difference { mean: 0.0, largest: 0 });
        exact.rgb = vec![[10, 20, 30], [0, 0, 0], [7, 7, 7], [9, 9, 9]];
        exact.covered = vec![true, false, false, false];
        other.rgb = vec![[12, 20, 29], [200, 0, 0], [8, 8, 8], [9, 9, 9]];
        other.covered = vec![true, false, true, false];
        assert_eq!(difference(&exact, &other), Difference { mean: 1.0, largest: 2 });
    }
}
