//! The live preview of a run in a browser (`--watch`).

mod live;
mod partial;
mod tiles;

pub use live::LivePreview;
pub use tiles::PreviewedTiles;
