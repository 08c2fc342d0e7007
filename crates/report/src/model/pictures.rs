//! Pictures and their quality.

use basrelief_reference::Quality;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The machine's pictures against the exact ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PictureQuality {
    /// Of the final picture.
    #[serde(flatten)]
    pub last: Quality,
    /// Of the final picture, in steps of its 8-bit values.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub difference: Option<Difference>,
    /// Of each picture in order of time; empty where only the final one was compared.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub frames: Vec<Quality>,
}

/// Absolute differences of 8-bit values, red, green and blue alike, over the pixels covered in either picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Difference {
    /// Rounded to 6 decimals \[steps of 1/255\].
    pub mean: f64,
    /// \[steps of 1/255\].
    pub largest: u8,
}

/// A picture that was written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Picture {
    /// File name, without the path.
    pub file: String,
    /// SHA-256 of its RGB rows, 8 bits per component, top row first, in hexadecimal; not of the file.
    pub sha256: String,
}
