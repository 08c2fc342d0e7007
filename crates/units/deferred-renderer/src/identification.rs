//! Identification of tiles (461), Figures 5A and 5B.

use crate::cell::split_depth;
use crate::config::{EngineConfig, RenderMode};
use crate::tokens::{CellBlock, MarkFlow, PassFlow, TileMark, TileMarks};
use crate::{ReferenceCell, TableSizes, TexturePage, interpolators, twin_tables};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, MemoryPorts, Step, Unit, UnitTable};
use basrelief_signals::Frame;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Returns the layers of a cell's interpolation: D_L, D_f, and D_G = D_L + 1 if D_f is above 0.
#[inline]
pub fn layers_of(page: &TexturePage, cell: &ReferenceCell) -> (u8, f32, Option<u8>) {
    let (coarse, fraction) = split_depth(cell.depth, page.dmax());
    (coarse, fraction, (fraction > 0.0).then_some(coarse + 1))
}

/// Collector of the marks of the pixels of one block.
#[derive(Clone, Debug, Default)]
pub struct BlockMarks {
    marks: TileMarks,
    distance: u32,
}

impl BlockMarks {
    /// Creates a collector for the block at this position. `centre` is that of the screen \[pixels\].
    #[inline]
    pub fn new(at: [u16; 2], centre: [u32; 2]) -> Self {
        let distance = [0, 1].map(|i| (u32::from(at[i]) * 4 + 2).abs_diff(centre[i]));
        Self { marks: TileMarks::new(), distance: distance[0] * distance[0] + distance[1] * distance[1] }
    }

    /// Counts one more pixel that needs this tile.
    #[inline]
    pub fn add(&mut self, page: u16, tile: u32) {
        match self.marks.iter_mut().find(|m| m.tile == tile && m.page == page) {
            Some(mark) => mark.pixels += 1,
            None => self.marks.push(TileMark { page, tile, pixels: 1, distance: self.distance }),
        }
    }

    /// Returns the token, or `None` without marks.
    #[inline]
    pub fn finish(self) -> Option<MarkFlow> {
        (!self.marks.is_empty()).then_some(MarkFlow::Marks(self.marks))
    }
}

/// Returns the centre of a frame's picture \[pixels\].
pub fn centre_of(frame: &Frame) -> [u32; 2] {
    [frame.width / 2, frame.height / 2]
}

/// Counters of the identification.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct IdentificationCounters {
    /// Tiles marked, counted per pixel and tile.
    pub marked: u64,
}

/// State of the identification between steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct IdentificationState {
    /// Pages so far, by number.
    pub pages: Vec<Arc<TexturePage>>,
    /// Centre of the frame's picture \[pixels\].
    pub centre: [u32; 2],
    /// Counters.
    pub counters: IdentificationCounters,
}

/// Identification (461): marks the tiles that the pixels of the reference buffer (126) need. Only the mode of best resolution uses it, so
/// a device of another mode has no operators for it.
#[derive(Clone, Debug)]
pub struct Identification {
    /// Parameters.
    pub config: EngineConfig,
    mode: RenderMode,
    sizes: TableSizes,
    /// State between steps.
    pub state: IdentificationState,
}

impl Identification {
    /// Creates the unit in its power-on state.
    pub fn new(config: EngineConfig, mode: RenderMode, sizes: TableSizes) -> Self {
        Self { config, mode, sizes, state: IdentificationState::default() }
    }

    /// Runs Figure 5A for every textured pixel of a block. Returns its token, and the number of layers tested.
    #[inline]
    fn identify(&mut self, block: &CellBlock) -> (Option<MarkFlow>, usize) {
        let mut marks = BlockMarks::new(block.at, self.state.centre);
        let mut looked_at = 0;
        for (_, cell) in block.drawn() {
            let Some(page) = cell.page().and_then(|p| self.state.pages.get(usize::from(p))) else { continue };
            let placed = page.placed(cell.coordinates, cell.wrap);
            let (coarse, _, fine) = layers_of(page, cell);
            for layer in [Some(coarse), fine].into_iter().flatten() {
                looked_at += 1;
                for tile in page.marked(layer, placed) {
                    marks.add(page.number, tile);
                    self.state.counters.marked += 1;
                }
            }
        }
        (marks.finish(), looked_at)
    }
}

impl Unit for Identification {
    basrelief_kernel::unit_info!("marks the tiles that pixels need (Figures 5A, 5B)");
    type In = Option<PassFlow>;
    type Out = Option<MarkFlow>;

    #[inline]
    fn demand(&self) -> Demand {
        Demand::All
    }

    #[inline(always)]
    fn step(&mut self, input: Self::In, _: &mut MemoryPorts) -> Step<Self::Out> {
        let latency = u64::from(self.config.latency);
        let out = match input {
            Some(PassFlow::Cells(block)) => {
                let (out, looked_at) = self.identify(&block);
                return Step::over(looked_at.div_ceil(self.config.scan_rate as usize), 1, latency, out);
            }
            Some(PassFlow::Frame(frame)) => {
                self.state.centre = centre_of(&frame);
                Some(MarkFlow::Frame)
            }
            Some(PassFlow::Page(page)) => {
                self.state.pages.push(Arc::clone(&page));
                Some(MarkFlow::Page(page))
            }
            Some(PassFlow::End) => Some(MarkFlow::End),
            Some(PassFlow::Begin) | None => None,
        };
        Step::after(latency, out)
    }

    fn twin_tables(&self) -> Vec<UnitTable> {
        self.state.pages.iter().flat_map(|page| twin_tables::of_page(page)).collect()
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        stats.figure("tiles_marked", self.state.counters.marked, "tiles", "Tiles marked, each time");
        if self.mode == RenderMode::Best {
            self.sizes.tell_block(stats);
            interpolators::tell_find(self.config.scan_rate, stats);
            interpolators::tell_marks(self.sizes, stats);
        }
    }
}
