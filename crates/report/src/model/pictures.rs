//! Pictures and their quality.

use crate::number::round6;
use basrelief_reference::QualityMetrics;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Quality of the images against reference images: of the final image, unless a name says otherwise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PictureQuality {
    /// Quality of the final image.
    #[serde(flatten)]
    pub last: QualityMetrics,
    /// Difference of the final image.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub difference: Option<Difference>,
    /// Quality of each image in order of time. Empty if only the final image was compared.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub frames: Vec<QualityMetrics>,
    /// Worst PSNR and SSIM of all images.
    #[serde(default)]
    pub min: LeastQuality,
    /// Worst FLIP of all images.
    #[serde(default)]
    pub max: LargestError,
    /// Mean over all images.
    #[serde(default = "no_quality")]
    pub mean: QualityMetrics,
}

/// Smallest measures of similarity over all images.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LeastQuality {
    /// Worst PSNR \[dB\].
    pub psnr_db: f64,
    /// Worst SSIM, -1 to 1.
    pub ssim: f64,
}

/// Largest measure of error over all images.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LargestError {
    /// Worst FLIP, 0 to 1.
    pub flip: f64,
}

/// Stands for the mean in a report of an earlier version until it is read completely.
fn no_quality() -> QualityMetrics {
    QualityMetrics { psnr_db: 0.0, ssim: 0.0, flip: 0.0 }
}

impl PictureQuality {
    /// Summarizes the images of a run, in order of time, with the difference of the final one. Returns `None` if there is none.
    pub fn of(pictures: &[QualityMetrics], difference: Option<Difference>) -> Option<Self> {
        let last = *pictures.last()?;
        let frames = if pictures.len() > 1 { pictures.to_vec() } else { vec![] };
        let (min, max, mean) = (LeastQuality::default(), LargestError::default(), no_quality());
        let mut quality = Self { last, difference, frames, min, max, mean };
        quality.summarize();
        Some(quality)
    }

    /// Computes minimum, maximum and mean from the images.
    pub(crate) fn summarize(&mut self) {
        let all = if self.frames.is_empty() { std::slice::from_ref(&self.last) } else { &self.frames[..] };
        let least = |of: fn(&QualityMetrics) -> f64| all.iter().map(of).fold(f64::INFINITY, f64::min);
        let mean = |of: fn(&QualityMetrics) -> f64| round6(all.iter().map(of).sum::<f64>() / all.len() as f64);
        self.min = LeastQuality { psnr_db: least(|q| q.psnr_db), ssim: least(|q| q.ssim) };
        self.max = LargestError { flip: -least(|q| -q.flip) };
        self.mean = QualityMetrics { psnr_db: mean(|q| q.psnr_db), ssim: mean(|q| q.ssim), flip: mean(|q| q.flip) };
    }
}

/// Absolute difference of 8-bit values of all colour components, over the pixels covered in either image.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Difference {
    /// Mean, rounded to 6 decimals \[steps of 1/255\].
    pub mean: f64,
    /// Largest \[steps of 1/255\].
    pub largest: u8,
}

/// An image of the run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Picture {
    /// File name, without the path.
    pub file: String,
    /// SHA-256 of the RGB rows, 8 bits per component, top row first, in hexadecimal. Not the hash of the file.
    pub sha256: String,
}
