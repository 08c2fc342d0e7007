//! Hashes of bodies and pictures, and checks of responses.

use basrelief_signals::Texture;
use sha2::{Digest as _, Sha256};

/// Hexadecimal digits of a hash.
pub const HASH_DIGITS: usize = 64;

/// Returns the SHA-256 in hexadecimal.
pub fn hash_of(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Returns bytes in hexadecimal.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Returns the SHA-256 of the picture of a texture: width and height as 4 bytes each, little-endian, then the RGBA texels of the finest
/// level.
pub fn hash_of_picture(texture: &Texture) -> [u8; 32] {
    let mut hash = Sha256::new();
    if let Some(image) = texture.levels.first() {
        hash.update(image.width.to_le_bytes());
        hash.update(image.height.to_le_bytes());
        hash.update(image.texels.as_flattened());
    }
    hash.finalize().into()
}

/// Returns the ETag of a body.
pub fn etag_of(body: &[u8]) -> String {
    etag_of_parts(&[body])
}

/// Returns the ETag of a body that consists of these parts.
pub fn etag_of_parts(parts: &[&[u8]]) -> String {
    let mut hash = Sha256::new();
    parts.iter().for_each(|part| hash.update(part));
    format!("\"{}\"", hex(&hash.finalize()))
}

/// Returns the hash of a body from its ETag.
///
/// # Errors
/// The ETag is no hash.
pub fn hash_from_etag(tag: &str) -> Result<&str, String> {
    let hash = tag.trim_start_matches("W/").trim_matches('"');
    if hash.len() == HASH_DIGITS {
        Ok(hash)
    } else {
        Err("no ETag that is the hash of the content: not a server of tiles".into())
    }
}

/// Checks the status of a response.
///
/// # Errors
/// Any status other than 200.
pub fn check_status(status: u16) -> Result<(), String> {
    match status {
        200 => Ok(()),
        403 => Err("http status: 403; the server does not answer to this name (`basrelief serve --allow-host NAME`)".into()),
        404 => Err("http status: 404; the server may have another scene by now".into()),
        _ => Err(format!("http status: {status}")),
    }
}

/// Checks the status of a response to a request for the scene.
///
/// # Errors
/// Any status other than 200.
pub fn check_scene_status(status: u16) -> Result<(), String> {
    match status {
        404 => {
            Err("http status: 404; the server has no scene with hashes of tiles: use a `basrelief serve` of the same version"
                .into())
        }
        _ => check_status(status),
    }
}

/// Checks the hash of a body.
///
/// # Errors
/// The body has another hash.
pub fn check_hash(body: &[u8], hash: &str) -> Result<(), String> {
    if hash == hash_of(body) { Ok(()) } else { Err("corrupt: the content does not have its hash".into()) }
}
