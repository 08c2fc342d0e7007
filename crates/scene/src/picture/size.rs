//! Limits of the size of a picture.

use crate::SceneError;

/// Maximum number of texels per side.
pub(crate) const MAX_SIDE: u32 = 16_384;

/// Bytes of a texel.
pub(super) const TEXEL: u64 = 4;

pub(super) fn check_size([width, height]: [u32; 2]) -> Result<(), SceneError> {
    if [width, height].iter().all(|side| (1..=MAX_SIDE).contains(side)) {
        return Ok(());
    }
    Err(SceneError::at("", format!("image is {width} x {height} texels"))
        .expected(format!("1..={MAX_SIDE} per side"))
        .cure("scale it down"))
}

/// Returns the words that name a picture as the reason of a reservation.
pub(super) fn texels_of(name: &str, [width, height]: [u32; 2]) -> String {
    format!("texels of {name}, an image of {width} x {height}")
}
