//! Hashes, of what comes and of pictures; and whether an answer is to be believed.

use basrelief_signals::Texture;
use sha2::{Digest as _, Sha256};

/// Hexadecimal digits of a hash.
pub const HASH_DIGITS: usize = 64;

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

/// ETag of a body.
pub fn etag_of(body: &[u8]) -> String {
    format!("\"{}\"", hash_of(body))
}

/// The hash that a body has, by its ETag.
///
/// # Errors
/// A sentence, where that is no hash.
pub fn hash_from_etag(tag: &str) -> Result<&str, String> {
    let hash = tag.trim_start_matches("W/").trim_matches('"');
    if hash.len() == HASH_DIGITS {
        Ok(hash)
    } else {
        Err("no ETag that is the hash of the content: not a server of tiles".into())
    }
}

/// Whether this status of an answer brings what was asked for.
///
/// # Errors
/// A sentence, where it does not.
pub fn check_status(status: u16) -> Result<(), String> {
    match status {
        200 => Ok(()),
        404 => Err("http status: 404; the server may have another scene by now".into()),
        _ => Err(format!("http status: {status}")),
    }
}

/// Whether a body has this hash.
///
/// # Errors
/// A sentence, where it has not.
pub fn check_hash(body: &[u8], hash: &str) -> Result<(), String> {
    if hash == hash_of(body) { Ok(()) } else { Err("corrupt: the content does not have its hash".into()) }
}
