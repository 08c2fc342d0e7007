//! The unit and its step.

use super::state::{RasterizationPhase, RasterizationState};
use crate::cell::CellFormat;
use crate::colour::{LayerChoice, best, progressive, sample, shaded};
use crate::config::{EngineConfig, RenderMode};
use crate::identification::{BlockMarks, centre_of};
use crate::records::{TileRecord, records_of};
use crate::server::place_of;
use crate::texels::PageTexels;
use crate::tokens::{CellBlock, ExpandedTile, MarkFlow, PassFlow, StoreOrder};
use crate::touched::{LastTexels, MOST_LINES};
use crate::{ReferenceCell, TableSizes, ViewpointEnds, interpolators};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, MemoryPorts, Step, Unit};
use basrelief_signals::{PictureFlow, PixelBlock};

/// Client of the texel cache.
const TEXELS: u32 = 0;
/// Client that writes tiles.
const STORE: u32 = 1;
/// Client that reads tiles for averaging.
const SOURCES: u32 = 2;

/// Final rasterization, and the texture-data memory (130) with its pyramids (134). It stores and averages tiles as ordered, then
/// colours the pixels of a pass.
///
/// Inputs: passes over the reference buffer (126), orders, tiles. Outputs: tiles that would improve a progressive picture, and
/// pixels. Client 0 is the texel cache, client 1 writes tiles, client 2 reads tiles for averaging.
#[derive(Clone, Debug)]
pub struct Rasterization {
    /// Parameters.
    pub config: EngineConfig,
    mode: RenderMode,
    leaving: ViewpointEnds,
    format: CellFormat,
    sizes: TableSizes,
    /// True if tile records are kept, frame by frame.
    pub keep: bool,
    /// State between steps.
    pub state: RasterizationState,
}

type Out = (Option<MarkFlow>, Option<PictureFlow>);

impl Rasterization {
    /// Creates the unit in its power-on state.
    pub fn new(config: EngineConfig, mode: RenderMode, leaving: ViewpointEnds, format: CellFormat, sizes: TableSizes) -> Self {
        Self { config, mode, leaving, format, sizes, keep: false, state: RasterizationState::default() }
    }

    /// Returns the pages and the received parts of their pyramids.
    pub fn pages(&self) -> &[PageTexels] {
        &self.state.pages
    }

    /// Returns the tile records of the frames finished since the last call, if they are kept: number of the frame, from 0, and
    /// its tiles.
    pub fn drain_records(&mut self) -> Vec<(u32, Vec<TileRecord>)> {
        std::mem::take(&mut self.state.records)
    }

    /// Returns the layers whose texels are found in a cycle. In the progressive mode, the search finds those that it tests.
    fn found_layers(&self) -> u32 {
        let EngineConfig { interpolation_rate, scan_rate, .. } = self.config;
        if self.mode == RenderMode::Progressive { scan_rate.max(interpolation_rate) } else { interpolation_rate }
    }

    fn order(&mut self, order: StoreOrder, traffic: &mut MemoryPorts) -> Step<Out> {
        match order {
            StoreOrder::Load { page, tile } => self.state.phase = RasterizationPhase::Tile(page, tile),
            StoreOrder::Synthesize { page, tile } => return self.synthesize(page, tile, traffic),
            StoreOrder::End => self.state.phase = RasterizationPhase::Cells,
            StoreOrder::Left => {
                self.state.is_left = true;
                self.state.phase = RasterizationPhase::Cells;
            }
        }
        Step::after(0, (None, None))
    }

    fn synthesize(&mut self, page: u16, tile: u32, traffic: &mut MemoryPorts) -> Step<Out> {
        let Some(texels) = self.state.pages.get_mut(usize::from(page)) else { return Step::after(0, (None, None)) };
        for (address, bytes) in texels.page.sources(tile).into_iter().map(|source| texels.page.range_of(source)) {
            traffic.read(SOURCES, address, bytes);
        }
        let (address, bytes) = texels.page.range_of(tile);
        traffic.write(STORE, address, bytes);
        let cycles = texels.page.texels_in(tile).div_ceil(self.config.average_rate.into());
        texels.synthesize(tile, self.state.frame);
        // The sources of the next tile may be this one.
        Step::after(0, (None, None)).busy(cycles).blocking()
    }

    fn store(&mut self, arrived: &ExpandedTile, traffic: &mut MemoryPorts) -> Step<Out> {
        let ExpandedTile { page, tile, texels } = arrived;
        let RasterizationPhase::Tile(number, ordered) = std::mem::replace(&mut self.state.phase, RasterizationPhase::Orders)
        else {
            return Step::after(0, (None, None));
        };
        if (number, ordered) != (page.number, *tile) {
            traffic.fault(format!("{}: came where another tile was expected; report this as a defect", place_of(page, *tile)));
        }
        if let Some(own) = self.state.pages.get_mut(usize::from(page.number)) {
            own.store(*tile, texels, self.state.frame);
        }
        let (address, bytes) = page.range_of(*tile);
        traffic.write(STORE, address, bytes);
        let cycles = (texels.len() as u64).div_ceil(self.config.average_rate.into());
        Step::after(0, (None, None)).busy(cycles.max(1))
    }

    fn pass(&mut self, token: PassFlow, traffic: &mut MemoryPorts) -> Step<Out> {
        let latency = u64::from(self.config.latency);
        match token {
            PassFlow::Frame(frame) => {
                self.state.frame += 1;
                self.state.pictures = 0;
                self.state.is_left = false;
                self.state.centre = centre_of(&frame);
                Step::after(latency, (None, Some(PictureFlow::Frame(frame))))
            }
            PassFlow::Page(page) => {
                self.state.pages.push(PageTexels::new(page));
                Step::after(latency, (None, None))
            }
            PassFlow::Begin => {
                self.state.improvable = false;
                self.state.phase = RasterizationPhase::Orders;
                Step::after(latency, (None, None))
            }
            PassFlow::Cells(block) => self.colour(&block, traffic),
            PassFlow::End => Step::after(latency, self.end_of_picture()),
        }
    }

    fn end_of_picture(&mut self) -> Out {
        self.state.pictures += 1;
        self.state.counters.pictures += 1;
        self.state.counters.most_pictures = self.state.counters.most_pictures.max(self.state.pictures.into());
        let last = !self.state.improvable || self.state.is_left || self.leaving.is_behind(self.state.pictures);
        if last && self.keep {
            self.state.records.push((self.state.frame as u32 - 1, records_of(&self.state.pages, self.state.frame)));
        }
        let marks = (self.mode == RenderMode::Progressive).then_some(MarkFlow::End);
        (marks, Some(PictureFlow::Show { last }))
    }

    /// Colours the drawn pixels of a block. A block without drawn pixels passes, because the picture has its background there.
    ///
    /// The search of Figure 7B, a pipeline stage ahead of the interpolation, takes a cycle for each word of the tile load list
    /// (136) that it reads. That is one word per layer, as in the identification (461), or more.
    #[inline]
    fn colour(&mut self, block: &CellBlock, traffic: &mut MemoryPorts) -> Step<Out> {
        let mut pixels = PixelBlock { at: block.at, mask: block.mask, rgb: [[0; 3]; 16] };
        let mut marks = BlockMarks::new(block.at, self.state.centre);
        let mut touched = [LastTexels::default(); 2];
        let (mut interpolations, mut words) = (0, 0);
        for (i, cell) in block.drawn() {
            pixels.rgb[i] = match cell.page() {
                None => {
                    self.state.counters.direct += 1;
                    cell.rgb()
                }
                Some(page) => {
                    let (rgb, layers, read) = self.textured(usize::from(page), cell, &mut marks, &mut touched, traffic);
                    interpolations += layers;
                    words += read;
                    rgb
                }
            };
        }
        self.state.counters.interpolations += interpolations as u64;
        self.state.counters.words += u64::from(words);
        let marks = marks.finish();
        self.state.improvable |= marks.is_some();
        let coloured = interpolations.max(block.mask.count_ones() as usize).div_ceil(self.config.interpolation_rate as usize);
        let cycles = coloured.max(words.div_ceil(self.config.scan_rate) as usize);
        let EngineConfig { latency, filter_latency, .. } = self.config;
        Step::over(cycles, 1, latency.into(), (marks, Some(PictureFlow::Pixels(pixels)))).after_data(filter_latency.min(latency))
    }

    /// Colours a textured pixel. Returns the number of layers used, and the words read of the tile load list.
    #[inline]
    fn textured(
        &mut self,
        page: usize,
        cell: &ReferenceCell,
        marks: &mut BlockMarks,
        touched: &mut [LastTexels; 2],
        traffic: &mut MemoryPorts,
    ) -> ([u8; 3], usize, u32) {
        let Some(texels) = self.state.pages.get_mut(page) else { return ([0; 3], 0, 0) };
        let placed = texels.page.placed(cell.coordinates, cell.wrap);
        let choice = match self.mode {
            RenderMode::Progressive => progressive(texels, cell, placed, self.config.list_rate),
            RenderMode::Best | RenderMode::Conventional => Some(best(texels, cell)),
        };
        let Some(choice) = choice else { return ([0; 3], 0, 0) };
        let LayerChoice { improve, words, .. } = choice;
        if let Some(layer) = improve {
            for tile in texels.page.marked(layer, placed).into_iter().filter(|t| !texels.exists(*t)) {
                marks.add(texels.page.number, tile);
            }
        }
        let sample = sample(texels, &choice, placed);
        let mut layers = 0;
        for (slot, (layer, taps)) in sample.read.into_iter().flatten().enumerate() {
            layers += 1;
            if improve.is_none() {
                texels.need(layer, &taps, self.state.frame);
            }
            touched[slot].look_up(&texels.page, layer, &taps, TEXELS, traffic);
        }
        self.state.counters.textured += 1;
        self.state.counters.between_layers += u64::from(choice.upper.is_some());
        (shaded(&self.format, cell, sample.colour), layers, words)
    }
}

impl Unit for Rasterization {
    basrelief_kernel::unit_info!("keeps pyramids (134) in (130), interpolates in and between layers (Figures 7A, 7B)");
    type In = (Option<PassFlow>, Option<StoreOrder>, Option<ExpandedTile>);
    type Out = Out;

    #[inline]
    fn demand(&self) -> Demand {
        match self.state.phase {
            RasterizationPhase::Cells => Demand::Only(0),
            RasterizationPhase::Orders => Demand::Only(1),
            RasterizationPhase::Tile(..) => Demand::Only(2),
        }
    }

    #[inline(always)]
    fn step(&mut self, (pass, order, tile): Self::In, traffic: &mut MemoryPorts) -> Step<Out> {
        if let Some(token) = pass {
            return self.pass(token, traffic);
        }
        if let Some(order) = order {
            return self.order(order, traffic);
        }
        match tile {
            Some(tile) => self.store(&tile, traffic),
            None => Step::after(0, (None, None)),
        }
    }

    /// Returns the lines of a block, one tile, and the sources of one tile.
    fn largest_step(&self, client: usize) -> u32 {
        [MOST_LINES, 1, 4].get(client).copied().unwrap_or(0)
    }

    fn is_empty(&self) -> bool {
        self.state.phase == RasterizationPhase::Cells
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        stats.rate(1, self.config.latency, 16_u32.div_ceil(self.config.interpolation_rate));
        let c = &self.state.counters;
        stats.figure("pixels_textured", c.textured, "pixels", "Pixels coloured by a texture");
        stats.figure("pixels_direct", c.direct, "pixels", "Pixels coloured by their cell");
        stats.figure("interpolations_within_layers", c.interpolations, "interpolations", "Bilinear interpolations");
        stats.figure("interpolations_between_layers", c.between_layers, "interpolations", "Interpolations between two layers");
        stats.figure("tile_list_words", c.words, "words", "Words of the tile load lists that searches read");
        stats.figure("most_pictures_per_frame", c.most_pictures, "pictures", "Most pictures of a frame");
        crate::layer_figures::tell(self.pages(), stats);
        self.sizes.tell_block(stats);
        self.sizes.tell_pages(&self.config, self.mode, stats);
        interpolators::tell_find(self.found_layers(), stats);
        interpolators::tell_interpolate(self.config.interpolation_rate, stats);
        interpolators::tell_average(self.config.average_rate, stats);
        if self.mode == RenderMode::Progressive {
            interpolators::tell_marks(self.sizes, stats);
        }
    }
}
