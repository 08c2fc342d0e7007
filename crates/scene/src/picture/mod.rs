//! PNG and JPEG decoding within limits.

mod jpeg;
mod size;

pub(crate) use size::MAX_SIDE;

use crate::SceneError;
use crate::outside::ImportContext;
use basrelief_input::MemoryReservation;
use basrelief_signals::Image;
use image::codecs::png::PngDecoder;
use image::{DynamicImage, ImageDecoder, ImageError, Limits};
use size::{TEXEL, check_size, texels_of};
use std::io::Cursor;

/// Memory that a decoder may take beyond its result \[bytes\].
const SCRATCH: u64 = 1 << 26;

/// Decodes a PNG or JPEG file, recognised by its content, into RGBA with 8 bits each (16-bit files are rounded). The
/// reservation is 4 bytes per texel.
///
/// # Errors
/// Neither PNG nor JPEG, corrupt, over [`MAX_SIDE`], or over the budget.
pub(crate) fn decode(bytes: &[u8], name: &str, outside: &ImportContext<'_>) -> Result<(Image, MemoryReservation), SceneError> {
    let decoded = match sniff(bytes) {
        Some(PictureFormat::Png) => decode_png(bytes, name, outside),
        Some(PictureFormat::Jpeg) => jpeg::decode(bytes, name, outside),
        None => Err(SceneError::at("", format!("neither PNG nor JPEG{}", look_alike(bytes)))
            .expected("a PNG or JPEG image under any file name")
            .cure("convert it")),
    };
    decoded.map_err(|e| e.in_file(name))
}

fn decode_png(bytes: &[u8], name: &str, outside: &ImportContext<'_>) -> Result<(Image, MemoryReservation), SceneError> {
    // Texts and colour profiles are expanded ahead of the dimensions: a file of a known length, by a thousand times.
    let most = SCRATCH.min(1024 * bytes.len() as u64).min(outside.left() / 4);
    let scratch = outside.take(most, "", "scratch memory of the PNG decoder")?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(scratch.bytes());
    let decoder = PngDecoder::with_limits(Cursor::new(bytes), limits).map_err(|e| png_fault(&e))?;
    let (width, height) = decoder.dimensions();
    check_size([width, height])?;
    let (texels, raw) = (u64::from(width) * u64::from(height), decoder.total_bytes());
    let rgba = TEXEL * texels;
    // The stored samples and their RGBA form are in memory together, then two copies of the RGBA form.
    let mut held = outside.take((raw + rgba).max(2 * rgba), "", texels_of(name, [width, height]))?;
    let image = Image { width, height, texels: rgba_texels(DynamicImage::from_decoder(decoder).map_err(|e| png_fault(&e))?) };
    held.shrink_to(rgba);
    Ok((image, held))
}

/// Converts a picture. The conversion of the `image` crate works in any colour space, and takes a hundred instructions per texel of the
/// most common kind, RGB with 8 bits each.
fn rgba_texels(picture: DynamicImage) -> Vec<[u8; 4]> {
    match picture {
        DynamicImage::ImageRgb8(rgb) => rgb.as_raw().as_chunks().0.iter().map(|[r, g, b]| [*r, *g, *b, 255]).collect(),
        other => other.into_rgba8().as_raw().as_chunks().0.to_vec(),
    }
}

/// A picture format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PictureFormat {
    Png,
    Jpeg,
}

/// The format that the first bytes announce.
pub(crate) fn sniff(bytes: &[u8]) -> Option<PictureFormat> {
    if bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        Some(PictureFormat::Png)
    } else if bytes.starts_with(&[0xff, 0xd8, 0xff]) {
        Some(PictureFormat::Jpeg)
    } else {
        None
    }
}

/// Name of another format, for the message.
fn look_alike(bytes: &[u8]) -> &'static str {
    match bytes {
        [] => " (the file is empty)",
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => " (a WebP image)",
        [0xab, b'K', b'T', b'X', ..] => " (a KTX texture)",
        [b'D', b'D', b'S', b' ', ..] => " (a DDS texture)",
        [b'G', b'I', b'F', b'8', ..] => " (a GIF image)",
        [b'B', b'M', ..] => " (a BMP image)",
        [0x89, b'P', b'N', b'G', ..] => " (a PNG whose signature was damaged, as by a text-mode transfer)",
        _ => "",
    }
}

fn png_fault(error: &ImageError) -> SceneError {
    let what = match error {
        ImageError::IoError(e) if e.kind() == std::io::ErrorKind::UnexpectedEof => "this PNG is cut off",
        ImageError::Limits(_) => "this PNG takes more memory to decode than its size allows",
        ImageError::Unsupported(_) => "this PNG is of a kind that is not supported",
        // The decoder's own words name its types and steps; a failed checksum means that bytes were changed.
        other if other.to_string().contains("CRC") => "this PNG is corrupt: a checksum does not match",
        _ => "this PNG is corrupt",
    };
    SceneError::at("", what).expected("a complete image").cure("open it in an image editor and save it again, or fetch it again")
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::MemoryFiles;
    use basrelief_input::MemoryPool;
    use image::{ImageBuffer, ImageFormat, Luma, Rgb, Rgba};

    fn decoded(bytes: &[u8], name: &str, limit: u64) -> Result<Image, SceneError> {
        let files = MemoryFiles::default();
        decode(bytes, name, &ImportContext::new(&files, &MemoryPool::new(limit))).map(|(image, _)| image)
    }

    /// A PNG file of this picture.
    pub(crate) fn png(width: u32, height: u32, texel: impl Fn(u32, u32) -> [u8; 4]) -> Vec<u8> {
        let picture = ImageBuffer::from_fn(width, height, |x, y| Rgba(texel(x, y)));
        let mut bytes = Cursor::new(Vec::new());
        DynamicImage::ImageRgba8(picture).write_to(&mut bytes, ImageFormat::Png).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn texels_come_top_row_first() {
        let image = decoded(&png(2, 2, |x, y| [x as u8, y as u8, 7, 9]), "a.jpg", 1 << 20).unwrap();
        assert_eq!(image.texels, [[0, 0, 7, 9], [1, 0, 7, 9], [0, 1, 7, 9], [1, 1, 7, 9]]);
    }

    #[test]
    fn sixteen_bits_become_eight() {
        let picture = ImageBuffer::from_fn(2, 1, |x, _| Luma([if x == 0 { 65535u16 } else { 257 * 20 }]));
        let mut bytes = Cursor::new(Vec::new());
        DynamicImage::ImageLuma16(picture).write_to(&mut bytes, ImageFormat::Png).unwrap();
        let image = decoded(&bytes.into_inner(), "a.png", 1 << 20).unwrap();
        assert_eq!(image.texels, [[255, 255, 255, 255], [20, 20, 20, 255]]);
    }

    #[test]
    fn texels_without_alpha_are_opaque() {
        let picture = ImageBuffer::from_fn(2, 1, |x, _| Rgb([x as u8, 200, 255]));
        let mut bytes = Cursor::new(Vec::new());
        DynamicImage::ImageRgb8(picture).write_to(&mut bytes, ImageFormat::Png).unwrap();
        let image = decoded(&bytes.into_inner(), "a.png", 1 << 20).unwrap();
        assert_eq!(image.texels, [[0, 200, 255, 255], [1, 200, 255, 255]]);
    }

    #[test]
    fn oversized_picture_is_not_decoded() {
        let error = decoded(&png(512, 512, |_, _| [0; 4]), "big.png", 2 << 20).unwrap_err();
        let text = error.to_string();
        assert!(text.starts_with("big.png: needs 2 MiB for texels of big.png, an image of 512 x 512, beside"), "{text}");
        assert!(text.contains("over the limit of 2 MiB; give more with --memory-limit") && error.over_budget, "{text}");
    }

    #[test]
    fn truncated_picture_is_an_error_that_names_the_file() {
        let whole = png(4, 4, |x, y| [(x * 60) as u8, (y * 60) as u8, 5, 255]);
        // The checksum of the end chunk is not needed to have all texels.
        for end in 0..whole.len() - 12 {
            let error = decoded(&whole[..end], "cut.png", 1 << 20).unwrap_err();
            assert!(error.to_string().starts_with("cut.png: "), "{error}");
        }
    }
}
