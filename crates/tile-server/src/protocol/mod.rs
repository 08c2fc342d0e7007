//! The tile protocol: addresses, encodings, hashes and checks, without any transport.

mod batch;
mod catalog;
mod encoding;
mod hash;
mod packed_scene;

pub use batch::{MAX_TILES_PER_REQUEST, join, max_tiles_per_request, split};
pub use catalog::{MAX_TILE_BYTES, TileCatalog, check_tile, tiles_path};
pub use encoding::{encoding_name, parse_encoding};
pub use hash::{HASH_DIGITS, check_hash, check_status, etag_of, hash_from_etag, hash_of, hash_of_picture, hex};
pub use packed_scene::{pack, unpack};

/// Lowest average rate that client and server accept \[bytes/s\]. A modem has 7,000 bytes/s, which 32 requests may share.
pub const MIN_BYTES_PER_SECOND: u64 = 100;
