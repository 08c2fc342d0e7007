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
mod desks;
mod exchange;
mod fetch;
mod hash;
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
pub use hash::{hash_of, hash_of_picture, hex};
pub use index::index_page;
pub use listen::Limits;
pub use meter::{Meter, Moment};
pub use scene::{pack, unpack};
pub use server::SceneService;
pub use site::Site;

/// Hexadecimal digits of a hash.
const DIGITS: usize = 64;
