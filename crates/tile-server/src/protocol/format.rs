//! Formats of tiles in addresses.

use basrelief_deferred_renderer::{TileEncoding, TileFormat};

/// Quality of encodings that have none.
const NO_QUALITY: u8 = 100;

/// Parses `WIDTHxHEIGHT/ENCODING`.
pub fn parse_format(text: &str) -> Option<TileFormat> {
    let (size, encoding) = text.split_once('/')?;
    let (width, height) = size.split_once('x')?;
    // One address per tile: `+64` and `064` are no sizes.
    let side = |s: &str| s.parse::<u32>().ok().filter(|n| n.is_power_of_two() && (4..=512).contains(n) && n.to_string() == s);
    let size = [side(width)?, side(height)?];
    match (encoding, encoding.strip_prefix("jpeg-")) {
        ("raw", _) => Some(TileFormat { size, encoding: TileEncoding::Raw, quality: NO_QUALITY }),
        ("png", _) => Some(TileFormat { size, encoding: TileEncoding::Png, quality: NO_QUALITY }),
        (_, Some(quality)) => {
            let number = quality.parse::<u8>().ok().filter(|q| (1..=100).contains(q));
            // `085` is no quality.
            let number = number.filter(|n| n.to_string() == quality);
            number.map(|quality| TileFormat { size, encoding: TileEncoding::Jpeg, quality })
        }
        _ => None,
    }
}

/// Returns `WIDTHxHEIGHT/ENCODING`.
pub fn format_name(format: TileFormat) -> String {
    let [width, height] = format.size;
    match format.encoding {
        TileEncoding::Raw => format!("{width}x{height}/raw"),
        TileEncoding::Png => format!("{width}x{height}/png"),
        TileEncoding::Jpeg => format!("{width}x{height}/jpeg-{}", format.quality),
    }
}

/// Returns the address of the scene with the hashes of tiles in this format.
pub fn scene_path(format: TileFormat) -> String {
    format!("scene/{}", format_name(format))
}

/// Returns the address of tiles of a picture.
pub fn tiles_path(picture: &str, format: TileFormat, tiles: &[u32]) -> String {
    let numbers: Vec<String> = tiles.iter().map(u32::to_string).collect();
    format!("tile/{picture}/{}/{}", format_name(format), numbers.join(","))
}

/// Returns the address of the list of a group of tiles of a picture.
pub fn hashes_path(picture: &str, format: TileFormat, group: u32) -> String {
    format!("hashes/{picture}/{}/{group}", format_name(format))
}

/// Returns the address of the size of all tiles of a layer of a picture.
pub(crate) fn bytes_path(picture: &str, format: TileFormat, layer: u8) -> String {
    format!("bytes/{picture}/{}/{layer}", format_name(format))
}
