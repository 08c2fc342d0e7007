//! Pictures and their quality.

use basrelief_reference::QualityMetrics;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Quality of the pictures against exact pictures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PictureQuality {
    /// Quality of the final picture.
    #[serde(flatten)]
    pub last: QualityMetrics,
    /// Difference of the final picture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub difference: Option<Difference>,
    /// Quality of each picture in order of time. Empty if only the final picture was compared.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub frames: Vec<QualityMetrics>,
}

/// Absolute difference of 8-bit values of all colour components, over the pixels covered in either picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Difference {
    /// Mean, rounded to 6 decimals \[steps of 1/255\].
    pub mean: f64,
    /// Largest \[steps of 1/255\].
    pub largest: u8,
}

/// A picture of the run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Picture {
    /// File name, without the path.
    pub file: String,
    /// SHA-256 of the RGB rows, 8 bits per component, top row first, in hexadecimal. Not the hash of the file.
    pub sha256: String,
}
