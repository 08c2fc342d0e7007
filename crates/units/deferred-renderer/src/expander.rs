//! Expansion of compressed tiles before they are stored.

use crate::config::TileConfig;
use crate::encoding::TileEncoding;
use crate::server::place_of;
use crate::tokens::{EncodedTile, ExpandedTile};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, Step, Unit};

/// Expander of tiles. Raw tiles pass. It has no state.
#[derive(Clone, Debug)]
pub struct Expander {
    /// Parameters.
    pub config: TileConfig,
    latency: u64,
    /// Maximum number of expanded tiles that wait to be stored.
    waiting: u32,
}

impl Expander {
    /// Creates an expander of tiles in this encoding, with buffers for `waiting` tiles.
    pub fn new(config: TileConfig, latency: u32, waiting: u32) -> Self {
        Self { config, latency: latency.into(), waiting }
    }

    /// Reports the JPEG hardware. Inverse cosine transform of 8 x 8 samples: 5 products and 29 sums for each row and each column
    /// (Arai, Agui, Nakajima, 1988), and a product per sample for its quantization. That is 9 and 29 for 4 samples. Colours: 4
    /// products, 6 sums.
    fn tell_jpeg(&self, stats: &mut UnitStats) {
        let rate = self.config.expand_rate;
        stats.hardware(HardwareKind::Multiplier, "inverse cosine transform, colours", (3 * 9 * rate).div_ceil(4) + 4 * rate, 16);
        stats.hardware(HardwareKind::Adder, "inverse cosine transform, colours", (3 * 29 * rate).div_ceil(4) + 6 * rate, 16);
        stats.hardware(HardwareKind::Table, "Huffman codes: 4 of 256", 4 * 256_u32, 8 + 16);
        stats.hardware(HardwareKind::Table, "quantization: 2 of 64", 2 * 64_u32, 8);
        stats.hardware(HardwareKind::Table, "blocks between rows and columns", 3 * 64_u32, 16);
    }

    /// Reports the PNG hardware. Inflation: a window of expanded bytes, and two codes. Then the filter of a row, of which Paeth's
    /// is the largest.
    fn tell_png(&self, stats: &mut UnitStats) {
        stats.hardware(HardwareKind::Table, "inflation: last 32 KiB", 32 * 1024_u32, 8);
        stats.hardware(HardwareKind::Table, "inflation: codes of 288 and 32", 288_u32 + 32, 16);
        stats.hardware(HardwareKind::Table, "row above", self.config.width, 24);
        stats.hardware(HardwareKind::Adder, "filters of a row", 3 * 7 * self.config.expand_rate, 8);
    }
}

impl Unit for Expander {
    basrelief_kernel::unit_info!("expands compressed tiles");
    type In = Option<EncodedTile>;
    type Out = Option<ExpandedTile>;

    fn demand(&self) -> Demand {
        Demand::All
    }

    fn step(&mut self, input: Self::In, traffic: &mut MemoryPorts) -> Step<Self::Out> {
        let Some(EncodedTile { page, tile, bytes }) = input else { return Step::after(0, None) };
        let size = page.texels_of(tile).size();
        match self.config.encoding.decode(&bytes, size) {
            Ok(texels) => {
                let raw = self.config.encoding == TileEncoding::Raw;
                let cycles = if raw { 1 } else { (texels.len() as u64).div_ceil(self.config.expand_rate.into()) };
                let latency = if raw { 0 } else { self.latency + cycles };
                Step::after(latency, Some(ExpandedTile { page, tile, texels: texels.into() })).busy(cycles)
            }
            Err(error) => {
                traffic.fault(format!("{}: {error}", place_of(&page, tile)));
                Step::after(0, None)
            }
        }
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        let texels = self.config.width * self.config.height;
        // No table: the number of buffers follows from the depth of a FIFO, and no work depends on it.
        stats.hardware(HardwareKind::LineBuffer, "expanded tiles", self.waiting + 1, 24 * texels);
        match self.config.encoding {
            TileEncoding::Raw => {}
            TileEncoding::Png => self.tell_png(stats),
            TileEncoding::Jpeg => self.tell_jpeg(stats),
        }
    }
}
