//! A real path: a scene without texels, and single tiles, over HTTP.
//!
//! | address | what |
//! |---|---|
//! | `/` | a page for people: what is served, and how to use it |
//! | `/scene` | the scene ([`basrelief_scene::Subject::to_bytes`]), compressed with zstd |
//! | `/tile/PICTURE/WIDTHxHEIGHT/ENCODING/NUMBER` | a tile of a picture that is cut into tiles of this size; ENCODING is `raw`, `png`, or `jpeg-QUALITY` |
//! | `/tile/PICTURE/WIDTHxHEIGHT/ENCODING/NUMBER,NUMBER,...` | several: of each its length, 4 bytes with the low one first, and itself |
//! | `/bytes/PICTURE/WIDTHxHEIGHT/ENCODING/LAYER` | bytes of all tiles of a layer, as a decimal number; layer 0 is the coarsest |
//!
//! PICTURE is the SHA-256 of the picture's texels ([`hash_of_picture`]): so what is at an address of a tile never changes, whatever is
//! served there, and whoever has it may keep it. Every answer carries the SHA-256 of its body as its ETag.

mod cache;
mod client;
mod exchange;
mod fetch;
mod http;
mod index;
mod listen;
mod meter;
mod scene;
mod server;
mod site;
#[cfg(test)]
mod tests;
mod user;

pub use cache::TileCache;
pub use client::{RemoteTiles, TileStore};
pub use fetch::{Fetcher, Patience};
pub use index::index_page;
pub use listen::Limits;
pub use meter::{Meter, Moment};
pub use scene::{pack, unpack};
pub use server::SceneService;
pub use site::Site;

use basrelief_signals::Texture;
use sha2::{Digest as _, Sha256};

/// Hexadecimal digits of a hash.
const DIGITS: usize = 64;

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
