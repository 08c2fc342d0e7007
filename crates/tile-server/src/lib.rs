//! Scenes and texture tiles over HTTP.
//!
//! | module | feature | content |
//! |---|---|---|
//! | [`protocol`] | | addresses, encodings, hashes and checks; the page in a browser uses this module alone |
//! | [`client`] | `client` | fetches the scene and tiles of a server |
//! | [`server`] | `server` | serves a scene, its tiles, and static files |
//! | [`preview`] | `preview` | shows the picture of a run in a browser |
//!
//! The server answers these paths:
//!
//! | path | content |
//! |---|---|
//! | `/scene/WIDTHxHEIGHT/ENCODING` | the scene ([`basrelief_scene::SceneSubject::to_bytes`]), [compressed](protocol::pack), and the [hashes](protocol::GroupHashes) of its tiles |
//! | `/hashes/PICTURE/WIDTHxHEIGHT/ENCODING/GROUP` | the hashes of the tiles of a group: 16 bytes for each tile |
//! | `/tile/PICTURE/WIDTHxHEIGHT/ENCODING/NUMBER` | one tile of a picture cut into tiles of this size; ENCODING is `raw`, `png`, or `jpeg-QUALITY` |
//! | `/tile/PICTURE/WIDTHxHEIGHT/ENCODING/NUMBER,NUMBER,...` | [several tiles](protocol::join): for each its length as 4 bytes, little-endian, then its bytes |
//! | `/bytes/PICTURE/WIDTHxHEIGHT/ENCODING/LAYER` | the total size of the tiles of a layer in bytes, as a decimal number; layer 0 is the coarsest |
//! | `/` | the viewer if it is built, otherwise the same as `/served` |
//! | `/served` | a page without scripts that lists the pictures and the commands to view them |
//! | `/page.css`, `/page.js`, `/worker.js`, `/basrelief.wasm` | the files of the viewer |
//!
//! PICTURE is the SHA-256 of the texels of the picture ([`protocol::hash_of_picture`]). Therefore the content at the address of a tile never
//! changes, and clients may cache it forever. Every response carries the SHA-256 of its body as its ETag.

#[cfg(feature = "client")]
pub mod client;
#[cfg(feature = "preview")]
pub mod preview;
pub mod protocol;
#[cfg(feature = "server")]
pub mod server;
#[cfg(test)]
mod tests;

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
