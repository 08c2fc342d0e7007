//! Several tiles in one response: for each its length and its bytes.

use basrelief_deferred_renderer::TexturePage;

/// Maximum number of tiles per request.
pub const MAX_TILES_PER_REQUEST: usize = 64;

/// Maximum size of the tiles of one request as raw texels \[bytes\]: 18 s at 56 kbit/s, which a failed tile costs again.
const MOST_BYTES: u64 = 1 << 17;

/// Returns the maximum number of tiles of a page per request.
pub fn max_tiles_per_request(page: &TexturePage) -> usize {
    let raw = 3 * page.cut.tile.map(u64::from).iter().product::<u64>();
    (MOST_BYTES / raw).clamp(1, MAX_TILES_PER_REQUEST as u64) as usize
}

/// Size of a length \[bytes\], little-endian.
const LENGTH: usize = 4;

/// Appends a tile.
pub fn join(tile: &[u8], several: &mut Vec<u8>) {
    several.extend((tile.len() as u32).to_le_bytes());
    several.extend(tile);
}

/// Splits a response into its tiles.
///
/// # Errors
/// The response does not hold exactly this number of tiles.
pub fn split(several: &[u8], tiles: usize) -> Result<Vec<&[u8]>, String> {
    let wrong = || format!("corrupt: not {tiles} tiles");
    let (mut all, mut rest) = (Vec::with_capacity(tiles.min(MAX_TILES_PER_REQUEST)), several);
    for _ in 0..tiles {
        let (length, behind) = rest.split_first_chunk::<LENGTH>().ok_or_else(wrong)?;
        let (tile, behind) = behind.split_at_checked(u32::from_le_bytes(*length) as usize).ok_or_else(wrong)?;
        all.push(tile);
        rest = behind;
    }
    if rest.is_empty() { Ok(all) } else { Err(wrong()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Claim: as page_batches_missing_tiles.
    #[test]
    fn batch_with_wrong_tile_count_is_refused() {
        let (tiles, mut sent) = ([&b"one"[..], b"", b"three"], vec![]);
        tiles.iter().for_each(|tile| join(tile, &mut sent));
        assert_eq!(split(&sent, 3).unwrap(), tiles);
        for length in 0..sent.len() {
            assert!(split(&sent[..length], 3).is_err(), "{length}");
        }
        assert!(split(&sent, 2).is_err() && split(&sent, 4).is_err());
        assert!(split(b"\xff\xff\xff\xffx", 1).is_err());
    }
}
