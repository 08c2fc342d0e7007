//! A subject as it travels to a renderer elsewhere: everything but texels.
//!
//! `basrelief-scene/2`, uncompressed, all numbers with the low byte first:
//!
//! | bytes | content |
//! |---|---|
//! | 18 | `basrelief-scene/2` and a line end |
//! | 4 | length of the head |
//! | that many | the [head](head::Head): names, textures, materials, objects, view, and how long the arrays are; postcard's encoding |
//! | the rest | the [arrays](arrays) of all meshes, one mesh after the other, each mesh once however many objects it has |
//!
//! Tangents are not sent. Only machines with normal maps use them, and these need the texels.

mod arrays;
mod head;
#[cfg(test)]
mod tests;

use crate::outside::over_budget;
use crate::{SceneError, SceneSubject};
use arrays::ArrayReader;
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_signals::{Mesh, Texture};
use head::SceneManifest;

/// First bytes of a packed scene.
const MAGIC: &[u8] = b"basrelief-scene/2\n";
/// Maximum memory per byte of the head, with lists that grow by doubling: an empty sentence is one byte there, and 24
/// here \[bytes\].
const HEAD_WEIGHT: u64 = 64;

impl SceneSubject {
    /// The subject without texels. `hash` gives the SHA-256 of a texture's picture, by which the other side asks for its tiles.
    ///
    /// # Errors
    /// Meshes or heads of more than 4 GiB.
    pub fn to_bytes(&self, hash: &mut dyn FnMut(&Texture) -> [u8; 32]) -> Result<Vec<u8>, SceneError> {
        let (head, meshes) = SceneManifest::of(self, hash);
        let head = postcard::to_allocvec(&head).map_err(|e| SceneError::at("head", e.to_string()))?;
        let length = u32::try_from(head.len()).map_err(|_| SceneError::at("head", "is longer than 4 GiB"))?;
        let mut bytes = [MAGIC, &length.to_le_bytes(), &head].concat();
        meshes.iter().for_each(|mesh| arrays::write(mesh, &mut bytes));
        Ok(bytes)
    }

    /// Reads and checks the output of [`to_bytes`](Self::to_bytes). The texels of the textures are
    /// [elsewhere](Texture::elsewhere). Returns the subject and its reservation. `name` is for messages.
    ///
    /// # Errors
    /// Bytes that are not a valid scene, with their place, or over the memory limit.
    pub fn from_bytes(bytes: &[u8], name: &str, budget: &MemoryPool) -> Result<(Self, MemoryReservation), SceneError> {
        read(bytes, budget).map_err(|e| e.in_file(name))
    }
}

fn read(bytes: &[u8], budget: &MemoryPool) -> Result<(SceneSubject, MemoryReservation), SceneError> {
    let rest = bytes.strip_prefix(MAGIC).ok_or_else(|| {
        SceneError::at("byte 0", "no scene").expected("`basrelief-scene/2`").cure("ask a `basrelief serve` of the same version")
    })?;
    let cut = || SceneError::at("head", "is cut short");
    let (length, rest) = rest.split_first_chunk::<4>().ok_or_else(cut)?;
    let length = u32::from_le_bytes(*length);
    let (head, rest) = rest.split_at_checked(length as usize).ok_or_else(cut)?;
    let held = budget.try_reserve(HEAD_WEIGHT * u64::from(length), "the head of a scene").map_err(|e| over_budget("head", &e))?;
    let (head, left): (SceneManifest, _) =
        postcard::take_from_bytes(head).map_err(|e| SceneError::at("head", format!("corrupt: {e}")))?;
    if !left.is_empty() {
        return Err(SceneError::at("head", format!("is {} bytes longer than it states", left.len())));
    }
    let mut arrays = ArrayReader::new(rest, budget, held);
    let meshes = (0..).zip(&head.meshes).map(|(i, mesh)| arrays.mesh(i, mesh)).collect::<Result<Vec<Mesh>, _>>()?;
    let held = arrays.finish()?;
    Ok((head.subject(meshes)?, held))
}
