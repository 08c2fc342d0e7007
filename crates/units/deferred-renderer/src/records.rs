//! Tile records, frame by frame, for auxiliary outputs.

use crate::TexturePage;
use crate::acquisition::TileOrigin;
use crate::texels::{PageTexels, TileHistory};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// State of a tile in a frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TileRecord {
    /// Page of the tile.
    pub page: Arc<TexturePage>,
    /// Number of the tile.
    pub tile: u32,
    /// Origin of the tile in this frame. `None` if it was already present and was needed.
    pub acquired: Option<TileOrigin>,
}

/// Returns the tiles that arrived in a frame (counted from 1), and the older ones that it needed.
pub(crate) fn records_of(pages: &[PageTexels], frame: u64) -> Vec<TileRecord> {
    let of_page = |texels: &PageTexels| {
        let page = Arc::clone(&texels.page);
        let of_tile = move |(tile, h): (usize, &TileHistory)| {
            let acquired = h.acquired.filter(|a| a.1 == frame).map(|a| a.0);
            let record = TileRecord { page: Arc::clone(&page), tile: tile as u32, acquired };
            (acquired.is_some() || (h.needed == frame && h.acquired.is_some())).then_some(record)
        };
        texels.history().iter().enumerate().filter_map(of_tile).collect::<Vec<_>>()
    };
    pages.iter().flat_map(of_page).collect()
}
