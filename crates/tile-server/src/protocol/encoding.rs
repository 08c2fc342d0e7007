//! Encodings in addresses.

use basrelief_deferred_renderer::TileEncoding;

/// Quality of encodings that have none.
const NO_QUALITY: u8 = 100;

/// Parses an encoding and its quality.
pub fn parse_encoding(text: &str) -> Option<(TileEncoding, u8)> {
    match (text, text.strip_prefix("jpeg-")) {
        ("raw", _) => Some((TileEncoding::Raw, NO_QUALITY)),
        ("png", _) => Some((TileEncoding::Png, NO_QUALITY)),
        (_, Some(quality)) => {
            let number = quality.parse::<u8>().ok().filter(|q| (1..=100).contains(q));
            // One address per tile: `085` is not a quality.
            number.filter(|n| n.to_string() == quality).map(|quality| (TileEncoding::Jpeg, quality))
        }
        _ => None,
    }
}

/// Returns the address of the scene with the hashes of tiles of this size and encoding.
pub fn scene_path([width, height]: [u32; 2], encoding: (TileEncoding, u8)) -> String {
    format!("scene/{width}x{height}/{}", encoding_name(encoding))
}

/// Returns the name of an encoding.
pub fn encoding_name((encoding, quality): (TileEncoding, u8)) -> String {
    match encoding {
        TileEncoding::Raw => "raw".into(),
        TileEncoding::Png => "png".into(),
        TileEncoding::Jpeg => format!("jpeg-{quality}"),
    }
}
