//! The live preview of a run in a browser (`--watch`).

mod live;
mod partial;

pub use live::LivePreview;
pub use partial::PreviewedTiles;
