//! Pictures as PNG files.

use basrelief_reference::Picture;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

/// A picture as a PNG file, with alpha 0 where nothing was drawn. In memory: the encoder would wrap what is wrong with a disk in words
/// of its own. (Beside the exact renderer, in one crate, it made that one 17 % slower: the compiler divided the crate otherwise.)
///
/// # Errors
/// What the encoder does not take, such as a picture without pixels.
pub fn to_png(picture: &Picture) -> Result<Vec<u8>, String> {
    let mut png = Vec::new();
    PngEncoder::new(&mut png)
        .write_image(&picture.to_rgba(), picture.width, picture.height, ExtendedColorType::Rgba8)
        .map_err(|error| error.to_string())?;
    Ok(png)
}
