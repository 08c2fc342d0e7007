//! Quality of a picture against the reference image: PSNR, SSIM and FLIP over the pixels covered in *either* picture. A missing pixel
//! counts as much as a wrong one, and the background does not count.
//!
//! The code is pure Rust in `f64`, with transcendental functions from `libm` only, rounded to 6 decimals, so that every host
//! computes the same bits. `nv-flip` was rejected: it needs a C++ compiler besides Rust, and it calls the host's `pow`, whose
//! last bits differ between systems. Both SSIM and FLIP are tested against the standard implementations of their fields.

mod covered;
mod filter;
mod flip;
mod ssim;

pub use covered::SizeMismatch;
pub use flip::flip;
pub use ssim::ssim;

use crate::RgbPicture;
use covered::{covered, rounded, same_size};

/// PSNR of identical pictures \[dB\], and the largest reported value.
pub const IDENTICAL_DB: f64 = 99.0;

/// Quality of a picture against the reference image.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct QualityMetrics {
    /// Peak signal-to-noise ratio over the pixels that either image covers \[dB\], at most 99; 99 if they are identical.
    pub psnr_db: f64,
    /// Structural similarity over the pixels that either image covers, -1..=1, 1 = identical.
    pub ssim: f64,
    /// FLIP error over the pixels that either image covers, as seen at 67 pixels per degree, 0..=1, 0 = identical.
    pub flip: f64,
}

impl QualityMetrics {
    /// Computes all three metrics.
    ///
    /// # Errors
    /// Returns an error if the pictures differ in size.
    pub fn measure(exact: &RgbPicture, other: &RgbPicture) -> Result<Self, SizeMismatch> {
        Ok(Self { psnr_db: psnr(exact, other)?, ssim: ssim(exact, other)?, flip: flip(exact, other)? })
    }
}

/// Computes the peak signal-to-noise ratio over red, green and blue of the pixels covered in either picture \[dB\]: `10 *
/// log10(255^2 / mean squared error)`, or [`IDENTICAL_DB`] if they are identical or no pixel is covered.
///
/// # Errors
/// Returns an error if the pictures differ in size.
pub fn psnr(exact: &RgbPicture, other: &RgbPicture) -> Result<f64, SizeMismatch> {
    same_size(exact, other)?;
    let mut sum = 0.0;
    let mut count = 0.0;
    for i in covered(exact, other) {
        for (a, b) in exact.rgb[i].into_iter().zip(other.rgb[i]) {
            let error = f64::from(a) - f64::from(b);
            sum += error * error;
        }
        count += 3.0;
    }
    if sum == 0.0 {
        return Ok(IDENTICAL_DB);
    }
    Ok(rounded((10.0 * libm::log10(255.0 * 255.0 * count / sum)).min(IDENTICAL_DB)))
}

/// Computes the absolute difference per channel, amplified eight times, saturated. A pixel is covered if it is covered in either
/// picture.
///
/// # Errors
/// Returns an error if the pictures differ in size.
pub fn difference(exact: &RgbPicture, other: &RgbPicture) -> Result<RgbPicture, SizeMismatch> {
    let mut result = steps(exact, other)?;
    result.rgb.as_flattened_mut().iter_mut().for_each(|step| *step = step.saturating_mul(8));
    Ok(result)
}

/// Computes the absolute difference per channel, amplified so that the largest of the picture becomes 255. Also returns the
/// largest difference.
///
/// # Errors
/// Returns an error if the pictures differ in size.
pub fn scaled_difference(exact: &RgbPicture, other: &RgbPicture) -> Result<(RgbPicture, u8), SizeMismatch> {
    let mut result = steps(exact, other)?;
    let steps = result.rgb.as_flattened_mut();
    let largest = steps.iter().copied().max().unwrap_or(0);
    for step in steps {
        *step = ((u32::from(*step) * 255 + u32::from(largest) / 2) / u32::from(largest.max(1))) as u8;
    }
    Ok((result, largest))
}

/// Computes the absolute difference per channel. A pixel is covered if it is covered in either picture.
fn steps(exact: &RgbPicture, other: &RgbPicture) -> Result<RgbPicture, SizeMismatch> {
    same_size(exact, other)?;
    let mut result = RgbPicture::new(exact.width, exact.height);
    for i in covered(exact, other) {
        result.covered[i] = true;
        for ((to, &a), b) in result.rgb[i].iter_mut().zip(&exact.rgb[i]).zip(other.rgb[i]) {
            *to = a.abs_diff(b);
        }
    }
    Ok(result)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Creates a picture with two thirds of its pixels covered, in colours without a pattern.
    pub(crate) fn noise(width: u32, height: u32, seed: u32) -> RgbPicture {
        let mut picture = RgbPicture::new(width, height);
        let mut state = seed;
        for (rgb, covered) in picture.rgb.iter_mut().zip(&mut picture.covered) {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let [_, r, g, b] = state.to_le_bytes();
            *covered = b % 3 != 0;
            *rgb = if *covered { [r, g, b] } else { [0; 3] };
        }
        picture
    }
}
