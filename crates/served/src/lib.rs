//! What a server of scenes sends, how it is named, and what is believed of it: the same for the server, for the program that
//! renders from it, and for the page in a browser. How bytes come from one to the other is no matter of this crate.
//!
//! | address | what |
//! |---|---|
//! | `/scene` | the scene ([`basrelief_scene::Subject::to_bytes`]), [compressed](pack) |
//! | `/tile/PICTURE/WIDTHxHEIGHT/ENCODING/NUMBER` | a tile of a picture that is cut into tiles of this size; ENCODING is `raw`, `png`, or `jpeg-QUALITY` |
//! | `/tile/PICTURE/WIDTHxHEIGHT/ENCODING/NUMBER,NUMBER,...` | [several](join): of each its length, 4 bytes with the low one first, and itself |
//! | `/bytes/PICTURE/WIDTHxHEIGHT/ENCODING/LAYER` | bytes of all tiles of a layer, as a decimal number; layer 0 is the coarsest |
//!
//! PICTURE is the SHA-256 of the picture's texels ([`hash_of_picture`]): so what is at an address of a tile never changes, whatever is
//! served there, and whoever has it may keep it. Every answer carries the SHA-256 of its body as its ETag.

mod encoding;
mod hash;
mod offered;
mod scene;
mod several;

pub use encoding::{encoding_name, encoding_of};
pub use hash::{DIGITS, check_hash, check_status, hash_in, hash_of, hash_of_picture, hex, tag_of};
pub use offered::{LARGEST_TILE, Offered, check_tile, tiles_address};
pub use scene::{pack, unpack};
pub use several::{MOST_TILES, join, most_together, split};
