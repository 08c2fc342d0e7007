//! The reference image of an imported scene beside the application's picture.

use crate::picture::ApplicationPicture;
use basrelief_reference::metrics::{QualityMetrics, SizeMismatch, scaled_difference};
use basrelief_reference::{RenderOptions, RgbPicture, TextureFilter, draw_scene_with_depth};
use basrelief_signals::{Frame, Scene};

/// Largest difference of depths that agree, as a share of the range of depths in the application's picture.
const DEPTH_TOLERANCE: f64 = 0.01;

/// Least tolerance of depths: two steps of a depth buffer with 16 bits.
const LEAST_TOLERANCE: f64 = 2.0 / 65_536.0;

/// Figures and pictures of a comparison.
#[derive(Clone, Debug)]
pub struct PictureComparison {
    /// The reference image. Its background has the colour of the application's.
    pub exact: RgbPicture,
    /// Absolute difference per channel, amplified so that the largest becomes 255.
    pub difference: RgbPicture,
    /// Largest difference, 0..=255.
    pub largest: u8,
    /// The application's picture, measured against the reference image.
    pub quality: QualityMetrics,
    /// Pixels of the picture.
    pub pixels: u64,
    /// Agreement of coverage and depth; `None` if the dump has no depth.
    pub geometry: Option<GeometryAgreement>,
}

/// Pixels on which two pictures disagree about the geometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GeometryAgreement {
    /// Pixels that only one picture covers.
    pub coverage: u64,
    /// Pixels that both cover, with depths that differ by more than 1 % of the range of depths: another surface is in front.
    pub depth: u64,
}

impl PictureComparison {
    /// Returns the share of pixels on which coverage and depth agree \[percent\]; `None` if the dump has no depth.
    pub fn agreement(&self) -> Option<f64> {
        let wrong = self.geometry.map(|geometry| geometry.coverage + geometry.depth)?;
        Some(100.0 * (1.0 - wrong as f64 / self.pixels.max(1) as f64))
    }

    /// Returns the agreement with three decimals, rounded down: only complete agreement is shown as 100.
    pub fn shown_agreement(&self) -> Option<String> {
        // The small number keeps a product just below a whole number.
        self.agreement().map(|percent| format!("{:.3}", (percent * 1e3 + 1e-6).floor() / 1e3))
    }
}

/// Draws the reference image of a scene and compares it with the application's.
///
/// # Errors
/// The frame has another size than the application's picture.
pub fn compare(
    scene: &Scene,
    frame: &Frame,
    filter: TextureFilter,
    application: &ApplicationPicture,
) -> Result<PictureComparison, SizeMismatch> {
    let options = RenderOptions { filter, ..RenderOptions::default() };
    let (mut exact, depth) = draw_scene_with_depth(scene, frame, &options);
    for (pixel, covered) in exact.rgb.iter_mut().zip(&exact.covered) {
        if !covered {
            *pixel = application.background;
        }
    }
    let quality = QualityMetrics::measure(&exact, &application.picture)?;
    let (difference, largest) = scaled_difference(&exact, &application.picture)?;
    let geometry = application.depth.as_ref().map(|other| geometry(&exact, &depth, &application.picture, other));
    Ok(PictureComparison { pixels: exact.rgb.len() as u64, exact, difference, largest, quality, geometry })
}

fn geometry(exact: &RgbPicture, depth: &[f64], other: &RgbPicture, other_depth: &[f32]) -> GeometryAgreement {
    let covered = other_depth.iter().zip(&other.covered).filter(|(_, covered)| **covered).map(|(depth, _)| f64::from(*depth));
    let [low, high] = covered.fold([1.0, 0.0], |[low, high]: [f64; 2], depth| [low.min(depth), high.max(depth)]);
    let tolerance = ((high - low) * DEPTH_TOLERANCE).max(LEAST_TOLERANCE);
    let mut result = GeometryAgreement { coverage: 0, depth: 0 };
    for ((a, depth), (b, other)) in exact.covered.iter().zip(depth).zip(other.covered.iter().zip(other_depth)) {
        result.coverage += u64::from(a != b);
        // A depth that is no number disagrees.
        let agrees = (depth - f64::from(*other)).abs() <= tolerance;
        result.depth += u64::from(*a && *b && !agrees);
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coverage_and_depth_are_counted_apart() {
        let picture = |covered: [bool; 4]| RgbPicture { covered: covered.into(), ..RgbPicture::new(4, 1) };
        let depths = [0.2, 0.5, 0.5, 1.0];
        let found =
            geometry(&picture([true, true, true, false]), &depths, &picture([true, true, false, true]), &[0.2, 0.6, 1.0, 0.3]);
        assert_eq!(found, GeometryAgreement { coverage: 2, depth: 1 });
        let near = geometry(&picture([true; 4]), &depths, &picture([true; 4]), &[0.2, 0.507, 0.493, f32::NAN]);
        assert_eq!(near, GeometryAgreement { coverage: 0, depth: 3 }, "1 % of 0.2 to 0.507 is less than 0.007");
    }
}
