//! A real path: polygons, texture sizes and single tiles over HTTP.
//!
//! | address | what |
//! |---|---|
//! | `/polygons` | a display list, binary and compressed; of its textures the sizes are right and the texels the number of the picture; [`LATER`] while it is made |
//! | `/tile/TEXTURE/WIDTHxHEIGHT/ENCODING/QUALITY/NUMBER` | a tile of a texture that is cut into tiles of this size |
//!
//! Every answer carries the SHA-256 of its body in [`HASH`], and that of all textures in [`TEXTURES`].

mod cache;
mod client;
mod fetch;
mod http;
mod listen;
mod server;
mod site;
#[cfg(test)]
mod tests;

pub use cache::TileCache;
pub use client::{RemoteTiles, TileStore};
pub use fetch::{Fetcher, Patience};
pub use listen::Limits;
pub use server::{PolygonList, TileService};
pub use site::Site;

use sha2::{Digest as _, Sha256};

/// Header with the SHA-256 of the body, in hexadecimal.
pub const HASH: &str = "x-content-sha256";
/// Header with the SHA-256 of all textures of the scene, in hexadecimal: tiles of others are of no use.
pub const TEXTURES: &str = "x-textures-sha256";

/// Status of `/polygons` while the server makes the list.
const LATER: u16 = 503;

/// Hexadecimal digits of a hash.
const DIGITS: usize = 64;

/// SHA-256 in hexadecimal.
pub fn hash_of(bytes: &[u8]) -> String {
    hex(Sha256::new_with_prefix(bytes))
}

/// What has been hashed, in hexadecimal.
pub fn hex(hash: Sha256) -> String {
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
