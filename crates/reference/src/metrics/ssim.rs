//! Structural similarity.

use super::filter::{Kernel, Rim, Strip, Window};
use super::{SizeMismatch, covered_in, mean, same_size, strip_pixels};
use crate::Picture;
use std::ops::Range;

const SIGMA: f64 = 1.5;
const RADIUS: usize = 5;
const C1: f64 = (0.01 * 255.0) * (0.01 * 255.0);
const C2: f64 = (0.03 * 255.0) * (0.03 * 255.0);

/// Mean structural similarity (Wang, Bovik, Sheikh and Simoncelli 2004) of the pixels covered in either picture,
/// -1..=1; 1 if nothing is covered. Rec. 601 luma, Gaussian window of 11 x 11 pixels with sigma 1.5, K1 = 0.01,
/// K2 = 0.03; beyond the rim the pictures are mirrored.
///
/// # Errors
/// If the pictures differ in size.
pub fn ssim(exact: &Picture, other: &Picture) -> Result<f64, SizeMismatch> {
    same_size(exact, other)?;
    let whole = Window { columns: 0..exact.width as usize, rows: 0..exact.height as usize };
    Ok(ssim_by(exact, other, &whole, strip_pixels(&whole)))
}

/// In strips of about so many pixels.
fn ssim_by(exact: &Picture, other: &Picture, whole: &Window, strip_pixels: usize) -> f64 {
    let kernel = Kernel::new(RADIUS, |d| libm::exp(-d * d / (2.0 * SIGMA * SIGMA))).normalised();
    mean(&Strip::all(strip_pixels, whole, RADIUS), 1.0, |strip| {
        let [x, y] = [exact, other].map(|picture| luma(picture, &strip.reached));
        let moments = Moments::new(&x, &y, whole.width(), &kernel);
        let first = strip.reached.start * whole.width();
        covered_in(exact, other, strip.rows.clone()).map(|i| moments.similarity(i - first)).collect()
    })
}

/// Blurred luma of both pictures, and of its products.
struct Moments {
    mean_x: Vec<f64>,
    mean_y: Vec<f64>,
    xx: Vec<f64>,
    yy: Vec<f64>,
    xy: Vec<f64>,
}

impl Moments {
    fn new(x: &[f64], y: &[f64], width: usize, kernel: &Kernel) -> Self {
        let blurred = |plane: &[f64]| kernel.down(&kernel.across(plane, width, Rim::Mirrored), width, Rim::Mirrored);
        let product = |a: &[f64], b: &[f64]| blurred(&a.iter().zip(b).map(|(a, b)| a * b).collect::<Vec<_>>());
        Self { mean_x: blurred(x), mean_y: blurred(y), xx: product(x, x), yy: product(y, y), xy: product(x, y) }
    }

    fn similarity(&self, at: usize) -> f64 {
        let Self { mean_x, mean_y, xx, yy, xy } = self;
        let (mx, my) = (mean_x[at], mean_y[at]);
        let variances = (xx[at] - mx * mx) + (yy[at] - my * my);
        let covariance = xy[at] - mx * my;
        (2.0 * mx * my + C1) * (2.0 * covariance + C2) / ((mx * mx + my * my + C1) * (variances + C2))
    }
}

/// Of these rows.
fn luma(picture: &Picture, rows: &Range<usize>) -> Vec<f64> {
    let width = picture.width as usize;
    let pixels = picture.rgb.get(rows.start * width..rows.end * width).unwrap_or_default();
    pixels.iter().map(|rgb| 0.299 * f64::from(rgb[0]) + 0.587 * f64::from(rgb[1]) + 0.114 * f64::from(rgb[2])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::tests::noise;

    #[test]
    fn strips_come_to_the_same_as_the_whole() {
        let (exact, other) = (noise(23, 41, 1), noise(23, 41, 2));
        let window = Window { columns: 0..23, rows: 0..41 };
        let whole = ssim_by(&exact, &other, &window, usize::MAX);
        for pixels in [1, 23 * 6, 23 * 30] {
            assert_eq!(ssim_by(&exact, &other, &window, pixels).to_bits(), whole.to_bits(), "{pixels}");
        }
    }
}
