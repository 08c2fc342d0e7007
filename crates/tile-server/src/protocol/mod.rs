//! The tile protocol: addresses, encodings, hashes and checks, without any transport.

mod batch;
mod catalog;
mod format;
mod hash;
mod packed_scene;
mod tile_hashes;

pub use batch::{MAX_TILES_PER_REQUEST, join, max_tiles_per_request, split};
pub use catalog::{MAX_TILE_BYTES, TileCatalog};
pub(crate) use format::bytes_path;
pub use format::{format_name, hashes_path, parse_format, scene_path, tiles_path};
pub use hash::{
    HASH_DIGITS, check_hash, check_scene_status, check_status, etag_of, etag_of_parts, hash_from_etag, hash_of, hash_of_picture,
    hex,
};
pub use packed_scene::{ReceivedScene, pack, unpack};
pub use tile_hashes::{
    GroupHashes, MAX_LIST_BYTES, TileHash, group_of, hash_of_list, hash_of_received, hash_of_tile, tiles_in_group,
};

/// Lowest average rate that client and server accept \[bytes/s\]. A modem has 7,000 bytes/s, which 32 requests may share.
pub const MIN_BYTES_PER_SECOND: u64 = 100;
