//! A compressed scene. Its uncompressed size counts against the memory limit before it is allocated.

use super::GroupHashes;
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_scene::SceneSubject;
use fdeflate::{DecompressionError, Decompressor};
use miniz_oxide::deflate;

/// Compression level.
const LEVEL: u8 = 9;
/// Bytes decompressed at a time.
const PART: usize = 1 << 15;

/// Compresses a scene in zlib format, which every language and browser reads.
pub fn pack(scene: &[u8]) -> Vec<u8> {
    deflate::compress_to_vec_zlib(scene, LEVEL)
}

/// A scene as a client receives it.
pub struct ReceivedScene {
    /// The scene; its texels are on the server.
    pub subject: SceneSubject,
    /// Hashes of the tiles of its pictures.
    pub hashes: GroupHashes,
    /// Memory of both.
    pub held: MemoryReservation,
}

/// Decompresses a scene with its hashes of tiles, received from `name`.
///
/// # Errors
/// Damaged data, or more than the memory limit. The message begins with `name`.
pub fn unpack(body: &[u8], name: &str, budget: &MemoryPool) -> Result<ReceivedScene, String> {
    let failed = |e| format!("{name}: no scene: {e}; is `basrelief serve` running there?");
    let (packed, hashes, hashes_held) = GroupHashes::split(body, budget).map_err(failed)?;
    let (bytes, _held) = unpacked(packed, budget).map_err(failed)?;
    let (subject, mut held) = SceneSubject::from_bytes(&bytes, name, budget).map_err(|e| e.to_string())?;
    held.join(hashes_held);
    Ok(ReceivedScene { subject, hashes, held })
}

/// Decompresses bytes.
fn unpacked(mut packed: &[u8], budget: &MemoryPool) -> Result<(Vec<u8>, MemoryReservation), String> {
    let (mut decompressor, mut scene, mut held) = (Decompressor::new(), Vec::new(), budget.empty_reservation());
    while !decompressor.is_done() {
        let at = scene.len();
        held.make_room(&mut scene, PART, "a scene").map_err(|e| e.to_string())?;
        scene.resize(at + PART, 0);
        let (read, written) = decompressor.read(packed, &mut scene, at, true).map_err(|e| match e {
            DecompressionError::InsufficientInput => "it is cut short".to_owned(),
            _ => "it cannot be unpacked".to_owned(),
        })?;
        packed = &packed[read..];
        scene.truncate(at + written);
    }
    Ok((scene, held))
}

#[cfg(test)]
mod tests {
    use super::*;

    // Claim: as page_batches_missing_tiles.
    #[test]
    fn damaged_scene_is_refused() {
        let scene: Vec<u8> = (0..200_000_u32).flat_map(|n| (n / 5 * 7).to_le_bytes()).collect();
        let (packed, budget) = (pack(&scene), MemoryPool::default());
        assert!(packed.len() < scene.len());
        assert!(unpacked(&packed, &budget).unwrap().0 == scene);
        for length in [0, 1, 2, packed.len() / 2, packed.len() - 5, packed.len() - 1] {
            assert_eq!(unpacked(&packed[..length], &budget).err().unwrap(), "it is cut short", "{length}");
        }
        let mut damaged = packed.clone();
        *damaged.last_mut().unwrap() ^= 1;
        assert_eq!(unpacked(&damaged, &budget).err().unwrap(), "it cannot be unpacked", "its checksum");
        assert!(unpacked(b"glTF and no more", &budget).is_err());
    }

    // Claim: as page_batches_missing_tiles.
    #[test]
    fn unpacked_scene_counts_against_memory_limit() {
        let packed = pack(&vec![0; 16 << 20]);
        assert!(packed.len() < 1 << 15);
        let budget = MemoryPool::new(1 << 20);
        assert!(unpacked(&packed, &budget).err().unwrap().contains("over the limit of 1 MiB"));
        assert_eq!(budget.left(), 1 << 20, "nothing is kept of it");
    }

    #[test]
    fn packed_scene_unpacks_unchanged() {
        let subject = SceneSubject::demo("cut-plane@1").unwrap();
        let sent = subject.to_bytes(&mut crate::protocol::hash_of_picture).unwrap();
        let body = |scene: &[u8]| [pack(scene), GroupHashes::default().to_bytes()].concat();
        let again = unpack(&body(&sent), "http://a/scene", &MemoryPool::default()).unwrap().subject;
        assert!(again.to_bytes(&mut |texture| texture.elsewhere.unwrap()).unwrap() == sent);
        let error = unpack(&body(b"other"), "http://a/scene", &MemoryPool::default()).err().unwrap();
        assert!(error.starts_with("http://a/scene: byte 0: no scene"), "{error}");
    }
}
