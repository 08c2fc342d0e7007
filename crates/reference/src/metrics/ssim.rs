//! Structural similarity.

use super::covered::{SizeMismatch, covered_in, mean, reach, same_size, strip_pixels};
use super::filter::{FilterKernel, FilterWindow, FilteredRows, PlaneSize, RimMode, RowStrip, due};
use crate::RgbPicture;
use std::ops::Range;

const SIGMA: f64 = 1.5;
const RADIUS: usize = 5;
const C1: f64 = (0.01 * 255.0) * (0.01 * 255.0);
const C2: f64 = (0.03 * 255.0) * (0.03 * 255.0);

/// Computes the mean structural similarity (Wang, Bovik, Sheikh and Simoncelli 2004) of the pixels covered in either picture,
/// -1..=1, or 1 if no pixel is covered. It uses Rec. 601 luma, a Gaussian window of 11 x 11 pixels with sigma 1.5, K1 = 0.01, K2
/// = 0.03. Beyond the rim the pictures are mirrored.
///
/// # Errors
/// Returns an error if the pictures differ in size.
pub fn ssim(exact: &RgbPicture, other: &RgbPicture) -> Result<f64, SizeMismatch> {
    same_size(exact, other)?;
    Ok(reach(exact, other, RADIUS).map_or(1.0, |window| ssim_by(exact, other, &window, strip_pixels(&window))))
}

/// Computes the similarity in strips of about this many pixels.
fn ssim_by(exact: &RgbPicture, other: &RgbPicture, window: &FilterWindow, strip_pixels: usize) -> f64 {
    let kernel = FilterKernel::new(RADIUS, |d| libm::exp(-d * d / (2.0 * SIGMA * SIGMA))).normalised();
    mean(&RowStrip::all(strip_pixels, window, RADIUS), 1.0, |strip| {
        let mut moments = LumaMoments::new(&kernel, PlaneSize { width: window.width(), height: strip.reached.len() });
        let mut similarities = Vec::with_capacity(strip.rows.len() * window.width());
        let mut taken = 0;
        for row in strip.rows.clone() {
            let at = row - strip.reached.start;
            for due in due(&mut taken, at + RADIUS, strip.reached.len()) {
                let [x, y] = [exact, other].map(|picture| luma(picture, strip.reached.start + due, &window.columns));
                moments.take(due, &x, &y);
            }
            moments.down(at, &kernel);
            let first = row * exact.width as usize + window.columns.start;
            similarities.extend(covered_in(exact, other, row..row + 1).map(|i| moments.similarity(i - first)));
        }
        similarities
    })
}

/// Blurred luma of both pictures, and of its products, for one row.
struct LumaMoments<'a> {
    /// Luma of both, its squares, and its product.
    rows: [FilteredRows<'a>; 5],
    blurred: [Vec<f64>; 5],
}

impl<'a> LumaMoments<'a> {
    fn new(kernel: &'a FilterKernel, size: PlaneSize) -> Self {
        let rows = || FilteredRows::new(kernel, RADIUS, size, RimMode::Mirrored);
        Self { rows: [(); 5].map(|()| rows()), blurred: [(); 5].map(|()| vec![0.0; size.width]) }
    }

    /// Receives a row of both pictures.
    fn take(&mut self, row: usize, x: &[f64], y: &[f64]) {
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).collect::<Vec<_>>();
        let planes = [x, y, &product(x, x), &product(y, y), &product(x, y)];
        self.rows.iter_mut().zip(planes).for_each(|(rows, plane)| rows.take(row, plane));
    }

    /// Moves to a row.
    fn down(&mut self, row: usize, kernel: &FilterKernel) {
        self.rows.iter().zip(&mut self.blurred).for_each(|(rows, blurred)| rows.down(row, kernel, blurred));
    }

    fn similarity(&self, at: usize) -> f64 {
        let [mx, my, xx, yy, xy] = self.blurred.each_ref().map(|plane| plane[at]);
        let variances = (xx - mx * mx) + (yy - my * my);
        let covariance = xy - mx * my;
        (2.0 * mx * my + C1) * (2.0 * covariance + C2) / ((mx * mx + my * my + C1) * (variances + C2))
    }
}

/// Returns the luma of these columns of a row.
fn luma(picture: &RgbPicture, row: usize, columns: &Range<usize>) -> Vec<f64> {
    let first = row * picture.width as usize;
    let pixels = picture.rgb.get(first + columns.start..first + columns.end).unwrap_or_default();
    pixels.iter().map(|rgb| 0.299 * f64::from(rgb[0]) + 0.587 * f64::from(rgb[1]) + 0.114 * f64::from(rgb[2])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::tests::noise;

    #[test]
    fn covered_part_matches_whole_picture() {
        for rows in [0..3, 9..20, 38..41] {
            let [exact, other] = [1, 2].map(|seed| {
                let mut picture = noise(23, 41, seed);
                picture
                    .covered
                    .iter_mut()
                    .enumerate()
                    .for_each(|(i, covered)| *covered = rows.contains(&(i / 23)) && i % 23 > 12);
                picture
            });
            let whole = FilterWindow { columns: 0..23, rows: 0..41 };
            let all = ssim_by(&exact, &other, &whole, usize::MAX);
            assert_eq!(ssim(&exact, &other).unwrap().to_bits(), all.to_bits(), "{rows:?}");
        }
    }

    #[test]
    fn strips_match_whole_picture() {
        let (exact, other) = (noise(23, 41, 1), noise(23, 41, 2));
        let window = FilterWindow { columns: 0..23, rows: 0..41 };
        let whole = ssim_by(&exact, &other, &window, usize::MAX);
        for pixels in [1, 23 * 6, 23 * 30] {
            assert_eq!(ssim_by(&exact, &other, &window, pixels).to_bits(), whole.to_bits(), "{pixels}");
        }
    }
}
