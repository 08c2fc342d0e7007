//! Structural similarity.

use super::filter::{Kernel, Rim, STRIP_PIXELS, Strip, Window};
use super::{SizeMismatch, mean, same_size};
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
    ssim_by(exact, other, STRIP_PIXELS)
}

/// In strips of about so many pixels.
fn ssim_by(exact: &Picture, other: &Picture, strip_pixels: usize) -> Result<f64, SizeMismatch> {
    same_size(exact, other)?;
    let [width, height] = [exact.width, exact.height].map(|side| side as usize);
    if exact.rgb.is_empty() {
        return Ok(1.0);
    }
    let kernel = Kernel::new(RADIUS, |d| libm::exp(-d * d / (2.0 * SIGMA * SIGMA))).normalised();
    let whole = Window { columns: 0..width, rows: 0..height };
    let mut current: Option<(Strip, Moments)> = None;
    Ok(mean(exact, other, 1.0, |i| {
        let row = i / width;
        // Given up before the next is made.
        current = current.take().filter(|(strip, _)| strip.rows.contains(&row));
        let (strip, Moments { mean_x, mean_y, xx, yy, xy }) = current.get_or_insert_with(|| {
            let strip = Strip::from(row, strip_pixels, &whole, RADIUS);
            let [x, y] = [exact, other].map(|picture| luma(picture, &strip.reached));
            (strip, Moments::new(&x, &y, width, &kernel))
        });
        let at = i - strip.reached.start * width;
        let (mx, my) = (mean_x[at], mean_y[at]);
        let variances = (xx[at] - mx * mx) + (yy[at] - my * my);
        let covariance = xy[at] - mx * my;
        (2.0 * mx * my + C1) * (2.0 * covariance + C2) / ((mx * mx + my * my + C1) * (variances + C2))
    }))
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
        let whole = ssim_by(&exact, &other, usize::MAX).unwrap();
        for pixels in [1, 23 * 6, 23 * 30] {
            assert_eq!(ssim_by(&exact, &other, pixels).unwrap().to_bits(), whole.to_bits(), "{pixels}");
        }
    }
}
