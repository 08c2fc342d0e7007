//! Hashes of tiles. A scene states one hash per group of tiles, which is the SHA-256 of the list of the group. The list holds the first
//! bytes of the SHA-256 of each tile. So a small scene fixes every tile, and a client fetches only the lists that it needs.
//!
//! The first group is tile 0 alone, the layer of a single tile. A client can compute its list from the tile, so the first progressive
//! picture needs no list.

use super::{hash_of, hex};
use basrelief_deferred_renderer::{TexturePage, TileEncoding, TileFormat};
use basrelief_input::{MemoryPool, MemoryReservation};
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;
use std::ops::Range;

/// Number of consecutive tiles of a picture in a group.
pub const TILES_PER_GROUP: u32 = 32;
/// Size of a hash in a list \[bytes\]. Another tile with the same hash cannot be found in practice.
const TILE_HASH: usize = 16;
/// Size of a SHA-256 \[bytes\].
const HASH: usize = 32;
/// Size of a length \[bytes\], little-endian.
const LENGTH: usize = 4;
/// Memory per byte of the hashes of a scene: a picture without groups has 36 bytes there \[bytes\].
const WEIGHT: u64 = 4;
/// Maximum size of a list \[bytes\].
pub const MAX_LIST_BYTES: u64 = TILES_PER_GROUP as u64 * TILE_HASH as u64;

/// Hashes of the groups of each picture, for one tile size and encoding. The key is the hexadecimal hash of the picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GroupHashes(BTreeMap<String, PictureHashes>);

/// Hash of a picture, and the hashes of its groups.
type PictureHashes = ([u8; HASH], Vec<[u8; HASH]>);

/// Hash of a tile, as lists hold it.
pub type TileHash = [u8; TILE_HASH];

/// Returns the group of a tile.
pub fn group_of(tile: u32) -> u32 {
    tile.div_ceil(TILES_PER_GROUP)
}

/// Returns the tiles of a group of a picture with this number of tiles.
pub fn tiles_in_group(group: u32, tiles: u32) -> Range<u32> {
    let end = group.saturating_mul(TILES_PER_GROUP).saturating_add(1);
    end.saturating_sub(TILES_PER_GROUP).min(tiles)..end.min(tiles)
}

/// Returns the hash of a tile: of its texels as RGB, or of the encoded tile if the encoding loses information.
///
/// # Errors
/// The tile cannot be encoded.
pub fn hash_of_tile(format: TileFormat, texels: &[[u8; 4]], size: [u32; 2]) -> Result<TileHash, String> {
    let encoding = if format.encoding == TileEncoding::Jpeg { TileEncoding::Jpeg } else { TileEncoding::Raw };
    encoding.encode(texels, size, format.quality).map(|bytes| hash_of_bytes(&bytes))
}

/// Returns the hash of a received tile.
///
/// # Errors
/// The tile is damaged or has another size.
pub fn hash_of_received(format: TileFormat, page: &TexturePage, tile: u32, body: &[u8]) -> Result<TileHash, String> {
    let size = page.texels_of(tile).size();
    let texels = format.encoding.decode(body, size).map_err(|e| format!("corrupt: {e}"))?;
    if format.encoding == TileEncoding::Jpeg { Ok(hash_of_bytes(body)) } else { hash_of_tile(format, &texels, size) }
}

fn hash_of_bytes(bytes: &[u8]) -> TileHash {
    let digest: [u8; HASH] = Sha256::digest(bytes).into();
    std::array::from_fn(|i| digest[i])
}

/// Returns the hash of a list.
pub fn hash_of_list(list: &[u8]) -> [u8; 32] {
    Sha256::digest(list).into()
}

/// Error of a tile with another hash.
const FALSE_TILE: &str = "not the tile that the scene states; the server, or a proxy before it, sends other tiles";

impl GroupHashes {
    /// Adds a picture with the hashes of its groups.
    pub fn insert(&mut self, picture: [u8; 32], groups: Vec<[u8; 32]>) {
        self.0.insert(hex(&picture), (picture, groups));
    }

    /// Checks the list of a group.
    ///
    /// # Errors
    /// The scene states no such group, or another hash.
    pub fn check_list(&self, picture: &str, group: u32, list: &[u8]) -> Result<(), String> {
        let stated = self.0.get(picture).and_then(|(_, groups)| groups.get(group as usize));
        let stated = stated.ok_or("the scene states no hash of these tiles")?;
        if hex(stated) == hash_of(list) { Ok(()) } else { Err("not the list that the scene states".into()) }
    }

    /// Checks the hash of a tile. `list` returns the checked list of its group.
    ///
    /// # Errors
    /// The tile has another hash, or there is no list.
    pub fn check_tile<L: AsRef<[u8]>>(
        &self,
        picture: &str,
        tile: u32,
        hash: TileHash,
        list: impl FnOnce() -> Result<L, String>,
    ) -> Result<(), String> {
        if tile == 0 {
            return self.check_list(picture, 0, &hash).map_err(|_| FALSE_TILE.into());
        }
        let list = list()?;
        let own = list.as_ref().as_chunks::<TILE_HASH>().0.get(((tile - 1) % TILES_PER_GROUP) as usize);
        if own == Some(&hash) { Ok(()) } else { Err(FALSE_TILE.into()) }
    }

    /// Returns the bytes behind a compressed scene: for each picture its hash, the number of groups and their hashes; then the length
    /// of all this.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        for (picture, groups) in self.0.values() {
            bytes.extend(picture);
            bytes.extend((groups.len() as u32).to_le_bytes());
            bytes.extend(groups.as_flattened());
        }
        bytes.extend((bytes.len() as u32).to_le_bytes());
        bytes
    }

    /// Splits a body into the compressed scene, the hashes and their memory.
    ///
    /// # Errors
    /// The body is cut short, the hashes do not have their length, or they exceed the memory limit.
    pub fn split<'a>(body: &'a [u8], budget: &MemoryPool) -> Result<(&'a [u8], Self, MemoryReservation), String> {
        let (before, length) = body.split_last_chunk::<LENGTH>().ok_or("it is cut short")?;
        let scene = before.len().checked_sub(u32::from_le_bytes(*length) as usize).ok_or("it is cut short")?;
        let (scene, mut rest) = before.split_at(scene);
        let held = budget.try_reserve(WEIGHT * rest.len() as u64, "hashes of tiles").map_err(|e| e.to_string())?;
        let mut hashes = Self::default();
        while !rest.is_empty() {
            let ((picture, groups), behind) = next_picture(rest).ok_or("its hashes of tiles are cut short")?;
            hashes.insert(picture, groups);
            rest = behind;
        }
        Ok((scene, hashes, held))
    }
}

/// Reads the hashes of one picture. Returns them and the bytes behind them.
fn next_picture(bytes: &[u8]) -> Option<(PictureHashes, &[u8])> {
    let (picture, rest) = bytes.split_first_chunk::<HASH>()?;
    let (groups, rest) = rest.split_first_chunk::<LENGTH>()?;
    let (groups, rest) = rest.split_at_checked((u32::from_le_bytes(*groups) as usize).checked_mul(HASH)?)?;
    Some(((*picture, groups.as_chunks::<HASH>().0.to_vec()), rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hashes() -> GroupHashes {
        let mut hashes = GroupHashes::default();
        hashes.insert([1; 32], vec![hash_of_list(b"a"), hash_of_list(b"b")]);
        hashes.insert([2; 32], vec![]);
        hashes
    }

    #[test]
    fn truncated_hashes_are_refused() {
        let body = [&b"scene"[..], &hashes().to_bytes()].concat();
        let split =
            |body: &[u8]| GroupHashes::split(body, &MemoryPool::default()).map(|(scene, hashes, _)| (scene.to_vec(), hashes));
        assert_eq!(split(&body), Ok((b"scene".to_vec(), hashes())));
        for length in 0..body.len() {
            // The count of the last picture may read as a length of 0.
            assert!(split(&body[..length]).map_or(true, |(_, found)| found == GroupHashes::default()), "{length}");
        }
        let (mut shorter, length) = (body.clone(), body.len());
        shorter[length - 4] -= 1;
        assert!(split(&shorter).is_err());
        assert!(GroupHashes::split(&body, &MemoryPool::new(100)).unwrap_err().contains("over the limit of 100 bytes"));
    }

    #[test]
    fn other_list_is_refused() {
        let (hashes, picture) = (hashes(), hex(&[1; 32]));
        assert_eq!(hashes.check_list(&picture, 1, b"b"), Ok(()));
        for (picture, group, list) in [(&*picture, 0, b"b"), (&picture, 2, b"b"), (&hex(&[2; 32]), 0, b"a"), ("none", 0, b"a")] {
            assert!(hashes.check_list(picture, group, list).is_err(), "{picture} {group}");
        }
    }

    #[test]
    fn groups_cover_every_tile_once() {
        for tiles in [1, 2, 33, 34, 100] {
            let groups = 0..=group_of(tiles - 1);
            assert!(groups.clone().all(|group| tiles_in_group(group, tiles).all(|tile| group_of(tile) == group)));
            assert_eq!(groups.flat_map(|group| tiles_in_group(group, tiles)).collect::<Vec<_>>(), (0..tiles).collect::<Vec<_>>());
        }
        assert!(tiles_in_group(u32::MAX, 5).is_empty());
    }

    #[test]
    fn other_tile_is_refused() {
        let [one, two] = [b"one", b"two"].map(|tile| hash_of_bytes(tile));
        let (list, picture, mut hashes) = ([one, two].concat(), hex(&[1; 32]), GroupHashes::default());
        hashes.insert([1; 32], vec![hash_of_list(&one), hash_of_list(&list)]);
        let check = |tile, hash| hashes.check_tile(&picture, tile, hash, || Ok(&list));
        assert_eq!([check(0, one), check(1, one), check(2, two)], [Ok(()), Ok(()), Ok(())]);
        assert!(check(0, two).is_err() && check(1, two).is_err() && check(3, two).is_err());
    }
}
