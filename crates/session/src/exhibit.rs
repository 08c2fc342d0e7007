//! What a machine shows beside its finished pictures.

use basrelief_deferred_renderer::{FilledBuffer, Page, TileList, TileRecord};
use basrelief_frame_buffer::ShownPicture;
use std::sync::Arc;

/// What a machine shows beside its finished pictures. All but the first only if [`Settings::log`] asks for it.
///
/// [`Settings::log`]: crate::Settings::log
#[derive(Clone, Debug, PartialEq)]
pub enum Exhibit {
    /// A picture that better ones of the same frame follow (progressive mode of the rate-limited renderer).
    Round(ShownPicture),
    /// The reference buffer (126), filled by a frame.
    ReferenceBuffer(FilledBuffer),
    /// Tiles that came in a frame, and those of earlier frames that it was coloured from.
    Tiles {
        /// Which frame, from 0.
        frame: u32,
        /// Tile by tile.
        tiles: Vec<TileRecord>,
    },
    /// Tile load lists (136) of all pages (132) at the end of the run.
    TileLists(Vec<(Arc<Page>, TileList)>),
}
