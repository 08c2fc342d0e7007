//! Encoding of tiles on the path. Pattern data may be compressed, and are expanded before they are stored.

use image::codecs::jpeg::{JpegDecoder, JpegEncoder};
use image::codecs::png::{CompressionType, FilterType, PngDecoder, PngEncoder};
use image::{ExtendedColorType, ImageDecoder, ImageEncoder, ImageResult, Limits};
use serde::{Deserialize, Serialize};
use std::io::Cursor;

/// Encoding of tiles on the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TileEncoding {
    /// R, G, B, 8 bits each.
    #[default]
    Raw,
    /// PNG, lossless.
    Png,
    /// JPEG, lossy.
    Jpeg,
}

/// Size and encoding of the tiles of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TileFormat {
    /// Width and height of a whole tile \[texels\].
    pub size: [u32; 2],
    /// Encoding of the tiles on the path.
    pub encoding: TileEncoding,
    /// JPEG quality, 1 to 100; other encodings ignore it.
    pub quality: u8,
}

impl TileEncoding {
    /// Encodes the texels of a tile of this size. `quality` (1..=100) applies to JPEG.
    ///
    /// # Errors
    /// Returns the encoder's message.
    pub fn encode(self, texels: &[[u8; 4]], size: [u32; 2], quality: u8) -> Result<Vec<u8>, String> {
        let rgb: Vec<u8> = texels.iter().flat_map(|t| [t[0], t[1], t[2]]).collect();
        let mut bytes = Vec::new();
        let written = match self {
            Self::Raw => return Ok(rgb),
            Self::Png => PngEncoder::new_with_quality(&mut bytes, CompressionType::Default, FilterType::Adaptive).write_image(
                &rgb,
                size[0],
                size[1],
                ExtendedColorType::Rgb8,
            ),
            Self::Jpeg => {
                JpegEncoder::new_with_quality(&mut bytes, quality).write_image(&rgb, size[0], size[1], ExtendedColorType::Rgb8)
            }
        };
        written.map(|()| bytes).map_err(|e| e.to_string())
    }

    /// Expands a tile of this expected size.
    ///
    /// # Errors
    /// Returns a sentence if the tile is truncated, corrupt, or of another size.
    pub fn decode(self, bytes: &[u8], size: [u32; 2]) -> Result<Vec<[u8; 4]>, String> {
        let rgb = match self {
            Self::Raw => bytes.to_vec(),
            Self::Png => read(PngDecoder::with_limits(Cursor::new(bytes), limits(size)), size)?,
            Self::Jpeg => read(JpegDecoder::new(Cursor::new(bytes)), size)?,
        };
        let expected = 3 * size[0] as usize * size[1] as usize;
        if rgb.len() != expected {
            return Err(format!("holds {} bytes of colour, expected {expected} for {} x {} texels", rgb.len(), size[0], size[1]));
        }
        Ok(rgb.as_chunks::<3>().0.iter().map(|&[r, g, b]| [r, g, b, 255]).collect())
    }
}

/// Returns the memory limit of a decoder: the picture twice, and a small extra. Colour profiles and texts, which are not needed,
/// can be a thousand times longer when expanded.
fn limits([width, height]: [u32; 2]) -> Limits {
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(2 * 3 * u64::from(width) * u64::from(height) + (1 << 16));
    limits
}

/// Reads a picture of exactly this size. Its header is checked before memory is allocated.
fn read<D: ImageDecoder>(decoder: ImageResult<D>, size: [u32; 2]) -> Result<Vec<u8>, String> {
    let decoder = decoder.map_err(|e| e.to_string())?;
    let (width, height) = decoder.dimensions();
    if [width, height] != size || decoder.color_type() != image::ColorType::Rgb8 {
        return Err(format!("is an image of {width} x {height}, expected RGB of {} x {}", size[0], size[1]));
    }
    let mut rgb = vec![0; 3 * size[0] as usize * size[1] as usize];
    decoder.read_image(&mut rgb).map_err(|e| e.to_string())?;
    Ok(rgb)
}
