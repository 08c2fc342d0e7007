//! A real path: polygons, texture sizes and single tiles over HTTP.
//!
//! | address | what |
//! |---|---|
//! | `/polygons` | a display list, binary and compressed; of its textures the sizes are right and the texels black |
//! | `/tile/TEXTURE/WIDTHxHEIGHT/ENCODING/QUALITY/NUMBER` | a tile of a texture that is cut into tiles of this size |
//!
//! Every answer carries the SHA-256 of its body in [`HASH`].

mod cache;
mod client;
mod server;
#[cfg(test)]
mod tests;

pub use cache::TileCache;
pub use client::{Patience, RemoteTiles, fetch_polygons};
pub use server::{Served, listen};

use sha2::{Digest as _, Sha256};

/// Header with the SHA-256 of the body, in hexadecimal.
pub const HASH: &str = "X-Content-SHA256";

/// SHA-256 in hexadecimal.
pub fn hash_of(bytes: &[u8]) -> String {
    hex(Sha256::new_with_prefix(bytes))
}

/// What has been hashed, in hexadecimal.
pub fn hex(hash: Sha256) -> String {
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
