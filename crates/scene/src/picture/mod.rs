//! PNG and JPEG decoding within limits.

mod jpeg;
mod size;

pub(crate) use size::MAX_SIDE;

use crate::SceneError;
use crate::outside::ImportContext;
use crate::pyramid::{HeightMap, heights_of};
use basrelief_input::MemoryReservation;
use basrelief_signals::Image;
use image::codecs::png::PngDecoder;
use image::{ColorType, DynamicImage, ImageDecoder, ImageError, Limits};
use size::{TEXEL, check_size, texels_of};
use std::io::Cursor;

/// Memory that a decoder may take beyond its result \[bytes\].
const SCRATCH: u64 = 1 << 26;

/// Bytes of a texel with 16 bits per component.
const DEEP_TEXEL: u64 = 8;

/// Bytes of a height.
pub(crate) const HEIGHT: u64 = size_of::<f64>() as u64;

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

/// Decodes a PNG or JPEG file into heights. 16-bit files keep their 16 bits. The reservation is [`HEIGHT`] bytes per texel.
///
/// # Errors
/// Errors of [`decode`].
pub(crate) fn decode_heights(
    bytes: &[u8],
    name: &str,
    outside: &ImportContext<'_>,
) -> Result<(HeightMap, MemoryReservation), SceneError> {
    if sniff(bytes) == Some(PictureFormat::Png) {
        return png_heights(bytes, name, outside).map_err(|e| e.in_file(name));
    }
    let (image, mut held) = decode(bytes, name, outside)?;
    let heights = HEIGHT * image.texels.len() as u64;
    held.join(outside.take(heights, "", texels_of(name, [image.width, image.height])).map_err(|e| e.in_file(name))?);
    let map = heights_of(&image);
    drop(image);
    held.shrink_to(heights);
    Ok((map, held))
}

fn decode_png(bytes: &[u8], name: &str, outside: &ImportContext<'_>) -> Result<(Image, MemoryReservation), SceneError> {
    let (picture, mut held) = read_png(bytes, name, outside, |_| [TEXEL; 2])?;
    let image = Image { width: picture.width(), height: picture.height(), texels: rgba_texels(picture) };
    held.shrink_to(TEXEL * image.texels.len() as u64);
    Ok((image, held))
}

fn png_heights(bytes: &[u8], name: &str, outside: &ImportContext<'_>) -> Result<(HeightMap, MemoryReservation), SceneError> {
    let form = |color| if is_deep(color) { DEEP_TEXEL } else { TEXEL };
    let (picture, mut held) = read_png(bytes, name, outside, |color| [form(color), HEIGHT])?;
    let size = [picture.width(), picture.height()];
    let map = if is_deep(picture.color()) {
        HeightMap::of_texels(size, picture.into_rgba16().as_raw().as_chunks().0, u16::MAX)
    } else {
        HeightMap::of_texels(size, &rgba_texels(picture), u8::MAX)
    };
    held.shrink_to(HEIGHT * map.heights.len() as u64);
    Ok((map, held))
}

/// Returns true for components of 16 bits.
fn is_deep(color: ColorType) -> bool {
    color.bytes_per_pixel() == 2 * color.channel_count()
}

/// Reads a PNG file. `sizes` returns the bytes per texel of its RGBA form and of the result that a caller makes of this form. The reservation
/// is enough for both.
fn read_png(
    bytes: &[u8],
    name: &str,
    outside: &ImportContext<'_>,
    sizes: impl FnOnce(ColorType) -> [u64; 2],
) -> Result<(DynamicImage, MemoryReservation), SceneError> {
    check_png_size(bytes)?;
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
    let [rgba, result] = sizes(decoder.color_type()).map(|size| size * u64::from(width) * u64::from(height));
    // The stored samples and their RGBA form are in memory together, then the RGBA form and the result.
    let held = outside.take(rgba + decoder.total_bytes().max(result), "", texels_of(name, [width, height]))?;
    let picture = DynamicImage::from_decoder(decoder).map_err(|e| png_fault(&e))?;
    Ok((picture, held))
}

/// Checks the size in the first chunk of a PNG file. The decoder takes a large size for a lack of memory.
fn check_png_size(bytes: &[u8]) -> Result<(), SceneError> {
    match bytes.get(8..24) {
        Some([_, _, _, _, b'I', b'H', b'D', b'R', size @ ..]) => {
            let [width, height] = [0, 4].map(|at| size.get(at..).and_then(|rest| rest.first_chunk()).copied());
            check_size([width, height].map(|side| u32::from_be_bytes(side.unwrap_or_default())))
        }
        _ => Ok(()),
    }
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
    fn heights_of_sixteen_bits_are_exact() {
        let heights = |picture: DynamicImage| {
            let (mut bytes, files) = (Cursor::new(Vec::new()), MemoryFiles::default());
            picture.write_to(&mut bytes, ImageFormat::Png).unwrap();
            decode_heights(&bytes.into_inner(), "a.png", &ImportContext::new(&files, &MemoryPool::new(1 << 20)))
                .unwrap()
                .0
                .heights
        };
        let deep = ImageBuffer::from_fn(3, 1, |x, _| Luma([[1000u16, 1001, 65535][x as usize]]));
        assert_eq!(heights(DynamicImage::ImageLuma16(deep)), [1000.0 / 65535.0, 1001.0 / 65535.0, 1.0]);
        let color = ImageBuffer::from_fn(1, 1, |_, _| Rgb([1u16, 2, 6]));
        assert_eq!(heights(DynamicImage::ImageRgb16(color)), [9.0 / (3.0 * 65535.0)]);
        let rgb = ImageBuffer::from_fn(1, 1, |_, _| Rgb([1u8, 2, 6]));
        assert_eq!(heights(DynamicImage::ImageRgb8(rgb)), [9.0 / (3.0 * 255.0)]);
    }

    #[test]
    fn wide_picture_names_its_size() {
        let error = decoded(&png(MAX_SIDE + 1, 1, |_, _| [0; 4]), "wide.png", 1 << 30).unwrap_err().to_string();
        assert_eq!(error, "wide.png: image is 16385 x 1 texels; expected 1..=16384 per side; scale it down");
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
