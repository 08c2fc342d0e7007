//! Names of pictures and tags of what is sent.

use basrelief_signals::Texture;
use sha2::{Digest as _, Sha256};

/// SHA-256 in hexadecimal.
pub fn hash_of(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// In hexadecimal.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// SHA-256 of a texture's picture: width and height in 4 bytes each, the low one first, and the RGBA texels of its finest level.
pub fn hash_of_picture(texture: &Texture) -> [u8; 32] {
    let mut hash = Sha256::new();
    if let Some(image) = texture.levels.first() {
        hash.update(image.width.to_le_bytes());
        hash.update(image.height.to_le_bytes());
        hash.update(image.texels.as_flattened());
    }
    hash.finalize().into()
}
