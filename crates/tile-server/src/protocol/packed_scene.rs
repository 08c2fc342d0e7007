//! A compressed scene. Its uncompressed size counts against the memory limit before it is allocated.

use basrelief_input::{Budget, Held};
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

/// Decompresses a scene received from `name`. Returns the scene and its memory.
///
/// # Errors
/// Damaged data, or more than the memory limit. The message begins with `name`.
pub fn unpack(packed: &[u8], name: &str, budget: &Budget) -> Result<(SceneSubject, Held), String> {
    let failed = |e| format!("{name}: no scene: {e}; is `basrelief serve` running there?");
    let (bytes, _held) = unpacked(packed, budget).map_err(failed)?;
    SceneSubject::from_bytes(&bytes, name, budget).map_err(|e| e.to_string())
}

/// Decompresses bytes.
fn unpacked(mut packed: &[u8], budget: &Budget) -> Result<(Vec<u8>, Held), String> {
    let (mut decompressor, mut scene, mut held) = (Decompressor::new(), Vec::new(), budget.nothing());
    while !decompressor.is_done() {
        let at = scene.len();
        held.room(&mut scene, PART, "a scene").map_err(|e| e.to_string())?;
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
        let (packed, budget) = (pack(&scene), Budget::default());
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
        let budget = Budget::new(1 << 20);
        assert!(unpacked(&packed, &budget).err().unwrap().contains("over the limit of 1 MiB"));
        assert_eq!(budget.left(), 1 << 20, "nothing is kept of it");
    }

    #[test]
    fn packed_scene_unpacks_unchanged() {
        let subject = SceneSubject::demo("cut-plane@1").unwrap();
        let sent = subject.to_bytes(&mut crate::protocol::hash_of_picture).unwrap();
        let (again, _held) = unpack(&pack(&sent), "http://a/scene", &Budget::default()).unwrap();
        assert!(again.to_bytes(&mut |texture| texture.elsewhere.unwrap()).unwrap() == sent);
        let error = unpack(&pack(b"other"), "http://a/scene", &Budget::default()).err().unwrap();
        assert!(error.starts_with("http://a/scene: byte 0: no scene"), "{error}");
    }
}
