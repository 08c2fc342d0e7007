//! Structural similarity.

use super::filter::{Kernel, Rim};
use super::{SizeMismatch, mean, same_size};
use crate::Picture;

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
    let width = exact.width as usize;
    if exact.rgb.is_empty() {
        return Ok(1.0);
    }
    let (x, y) = (luma(exact), luma(other));
    let kernel = Kernel::new(RADIUS, |d| libm::exp(-d * d / (2.0 * SIGMA * SIGMA))).normalised();
    let blurred = |plane: &[f64]| kernel.down(&kernel.across(plane, width, Rim::Mirrored), width, Rim::Mirrored);
    let product = |a: &[f64], b: &[f64]| blurred(&a.iter().zip(b).map(|(a, b)| a * b).collect::<Vec<_>>());
    let (mean_x, mean_y) = (blurred(&x), blurred(&y));
    let (xx, yy, xy) = (product(&x, &x), product(&y, &y), product(&x, &y));
    Ok(mean(exact, other, 1.0, |i| {
        let (mx, my) = (mean_x[i], mean_y[i]);
        let variances = (xx[i] - mx * mx) + (yy[i] - my * my);
        let covariance = xy[i] - mx * my;
        (2.0 * mx * my + C1) * (2.0 * covariance + C2) / ((mx * mx + my * my + C1) * (variances + C2))
    }))
}

fn luma(picture: &Picture) -> Vec<f64> {
    picture.rgb.iter().map(|rgb| 0.299 * f64::from(rgb[0]) + 0.587 * f64::from(rgb[1]) + 0.114 * f64::from(rgb[2])).collect()
}
