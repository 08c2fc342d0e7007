//! Unfinished picture for an observer of a real path. The device itself shows none between its rounds.

use crate::cell::CellFormat;
use crate::colour::{progressive, sample, shaded};
use crate::encoding::TileEncoding;
use crate::texels::PageTexels;
use crate::{FilledBuffer, ReferenceCell, TexturePage};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Entries of a word of the tile load lists (136). The preview ignores the number of words read.
const ENTRIES: u32 = 1;

/// Tiles received so far, and the formats that colour a picture from them.
#[derive(Clone, Debug)]
pub struct PicturePreview {
    format: CellFormat,
    encoding: TileEncoding,
    /// Texels of each page, by number.
    pages: BTreeMap<u16, PageTexels>,
}

impl PicturePreview {
    /// Creates an empty preview of cells of this format, and tiles of this encoding.
    pub fn new(format: CellFormat, encoding: TileEncoding) -> Self {
        Self { format, encoding, pages: BTreeMap::new() }
    }

    /// Stores a received tile. The device reports tiles that cannot be expanded.
    pub fn store(&mut self, page: &Arc<TexturePage>, tile: u32, bytes: &[u8]) {
        let Ok(texels) = self.encoding.decode(bytes, page.texels_of(tile).size()) else { return };
        let own = self.pages.entry(page.number).or_insert_with(|| PageTexels::new(Arc::clone(page)));
        own.store(tile, &texels, 0);
        let mut finer = tile;
        while let Some(average) = own.average_of(finer) {
            own.synthesize(average, 0);
            finer = average;
        }
    }

    /// Returns the unfinished picture of a filled reference buffer (126), row by row. Each pixel is coloured as in the
    /// progressive mode (472) from the received tiles. A pixel is `None` if it is not drawn or has no tile.
    pub fn picture(&self, filled: &FilledBuffer) -> Vec<Option<[u8; 3]>> {
        filled.cells.iter().map(|cell| self.colour(cell)).collect()
    }

    fn colour(&self, cell: &ReferenceCell) -> Option<[u8; 3]> {
        let Some(page) = cell.page() else { return cell.is_drawn().then(|| cell.rgb()) };
        let texels = self.pages.get(&page)?;
        let placed = texels.page.placed(cell.coordinates, cell.wrap);
        let choice = progressive(texels, cell, placed, ENTRIES)?;
        Some(shaded(&self.format, cell, sample(texels, &choice, placed).colour))
    }
}
