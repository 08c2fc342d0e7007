//! PNG encoding.

use basrelief_reference::RgbPicture;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

/// Encodes a picture as PNG, with alpha 0 for pixels that are not covered. The result is in memory, because the encoder would hide the
/// text of a disk error. The encoder is not in the crate of the exact renderer, because that made the renderer 17 % slower: the compiler
/// divided the crate into other units.
///
/// # Errors
/// Pictures that the encoder rejects, such as one without pixels.
pub fn to_png(picture: &RgbPicture) -> Result<Vec<u8>, String> {
    let mut png = Vec::new();
    PngEncoder::new(&mut png)
        .write_image(&picture.to_rgba(), picture.width, picture.height, ExtendedColorType::Rgba8)
        .map_err(|error| error.to_string())?;
    Ok(png)
}
