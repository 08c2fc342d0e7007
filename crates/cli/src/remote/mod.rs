//! A real path: a scene without texels, and single tiles, over HTTP. What there is at which address, and how it is checked, is told
//! in [`basrelief_served`]; beside that there are, for people:
//!
//! | address | what |
//! |---|---|
//! | `/` | the viewer, the page in a browser, where it is built; otherwise as `/served` |
//! | `/served` | a page without a script: what is served, and how to use it |
//! | `/page.css`, `/page.js`, `/worker.js`, `/basrelief.wasm` | what the viewer is made of |

mod cache;
mod client;
mod desks;
mod exchange;
mod fetch;
mod growing;
mod http;
mod index;
mod listen;
mod meter;
mod server;
mod site;
#[cfg(test)]
mod tests;
mod user;
mod watching;

pub use cache::TileCache;
pub use client::{RemoteTiles, TileStore};
pub use fetch::{Fetcher, Patience};
pub use growing::WatchedTiles;
pub use index::index_page;
pub use listen::Limits;
pub use meter::{Meter, Moment};
pub use server::SceneService;
pub use site::Site;
pub use watching::Watched;
