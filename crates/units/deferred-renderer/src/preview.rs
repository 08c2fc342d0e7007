//! A picture that is still growing, for who watches a real path: outside of the device, which shows none between its rounds.

use crate::cell::CellFormat;
use crate::colour::{progressive, sample, shaded};
use crate::encoding::TileEncoding;
use crate::texels::PageTexels;
use crate::{Cell, FilledBuffer, Page};
use std::collections::BTreeMap;
use std::fmt::Debug;
use std::sync::Arc;

/// Entries of a word of the tile load lists (136): how many words are read is no matter here.
const ENTRIES: u32 = 1;

/// Who watches a real path; in the model nobody does.
pub trait Onlooker: Debug + Send + Sync {
    /// The reference buffer (126) of a view is filled; the tiles that it wants are asked for next.
    fn filled(&self, filled: FilledBuffer);
}

/// Tiles that have come, and how a picture is coloured from them.
#[derive(Clone, Debug)]
pub struct Preview {
    format: CellFormat,
    encoding: TileEncoding,
    /// By number.
    pages: BTreeMap<u16, PageTexels>,
}

impl Preview {
    /// Of cells of this format, and tiles of this encoding; none have come.
    pub fn new(format: CellFormat, encoding: TileEncoding) -> Self {
        Self { format, encoding, pages: BTreeMap::new() }
    }

    /// A tile has come. One that cannot be expanded is the device's to report.
    pub fn store(&mut self, page: &Arc<Page>, tile: u32, bytes: &[u8]) {
        let (first, end) = page.texels_of(tile);
        let Ok(texels) = self.encoding.decode(bytes, [end[0] - first[0], end[1] - first[1]]) else { return };
        let own = self.pages.entry(page.number).or_insert_with(|| PageTexels::new(Arc::clone(page)));
        own.store(tile, &texels, 0);
        let mut finer = tile;
        while let Some(average) = own.average_of(finer) {
            own.synthesize(average, 0);
            finer = average;
        }
    }

    /// The picture so far, row by row: of a filled reference buffer (126), each pixel as the progressive mode colours it (472) from the
    /// tiles that have come; none where nothing was drawn, or no tile has come.
    pub fn picture(&self, filled: &FilledBuffer) -> Vec<Option<[u8; 3]>> {
        filled.cells.iter().map(|cell| self.colour(cell)).collect()
    }

    fn colour(&self, cell: &Cell) -> Option<[u8; 3]> {
        let Some(page) = cell.page() else { return cell.is_drawn().then(|| cell.rgb()) };
        let texels = self.pages.get(&page)?;
        let placed = texels.page.placed(cell.coordinates, cell.wrap);
        let choice = progressive(texels, cell, placed, ENTRIES)?;
        Some(shaded(&self.format, cell, sample(texels, &choice, placed).colour))
    }
}
