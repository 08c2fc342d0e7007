//! Encodings, as addresses say them.

use basrelief_deferred_renderer::TileEncoding;

/// Whatever the quality, where there is none.
const NO_QUALITY: u8 = 100;

/// An encoding and its quality, as an address says them.
pub fn parse_encoding(text: &str) -> Option<(TileEncoding, u8)> {
    match (text, text.strip_prefix("jpeg-")) {
        ("raw", _) => Some((TileEncoding::Raw, NO_QUALITY)),
        ("png", _) => Some((TileEncoding::Png, NO_QUALITY)),
        (_, Some(quality)) => {
            let number = quality.parse::<u8>().ok().filter(|q| (1..=100).contains(q));
            // One address for one tile: no 085.
            number.filter(|n| n.to_string() == quality).map(|quality| (TileEncoding::Jpeg, quality))
        }
        _ => None,
    }
}

/// An encoding as an address says it.
pub fn encoding_name((encoding, quality): (TileEncoding, u8)) -> String {
    match encoding {
        TileEncoding::Raw => "raw".into(),
        TileEncoding::Png => "png".into(),
        TileEncoding::Jpeg => format!("jpeg-{quality}"),
    }
}
