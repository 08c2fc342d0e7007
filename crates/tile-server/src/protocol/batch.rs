//! Several tiles in one answer: of each its length, and itself.

use basrelief_deferred_renderer::TexturePage;

/// Most tiles that one request asks for.
pub const MAX_TILES_PER_REQUEST: usize = 64;

/// What the tiles of one request take at most as raw texels \[bytes\]: 18 s at 56 kbit/s, and asked for again where one of them fails.
const MOST_BYTES: u64 = 1 << 17;

/// How many tiles of a page one request asks for at most.
pub fn max_tiles_per_request(page: &TexturePage) -> usize {
    let raw = 3 * page.cut.tile.map(u64::from).iter().product::<u64>();
    (MOST_BYTES / raw).clamp(1, MAX_TILES_PER_REQUEST as u64) as usize
}

/// Bytes of a length: low one first.
const LENGTH: usize = 4;

/// Puts one tile more behind the others.
pub fn join(tile: &[u8], several: &mut Vec<u8>) {
    several.extend((tile.len() as u32).to_le_bytes());
    several.extend(tile);
}

/// The tiles of an answer that should hold so many.
///
/// # Errors
/// A sentence, where it does not hold just these.
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

    #[test]
    fn several_tiles_arrive_as_they_were_sent_and_fewer_or_more_are_refused() {
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
