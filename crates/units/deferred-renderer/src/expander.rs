//! Expansion of compressed tiles before they are stored.

use crate::config::TileConfig;
use crate::encoding::TileEncoding;
use crate::server::place_of;
use crate::tokens::{EncodedTile, ExpandedTile};
use basrelief_kernel::{Demand, Step, Traffic, Unit};

/// Expands tiles. Raw ones pass. It remembers nothing: there is no state.
#[derive(Clone, Debug)]
pub struct Expander {
    /// Parameters.
    pub config: TileConfig,
    latency: u64,
}

impl Expander {
    /// An expander of tiles that are encoded so.
    pub fn new(config: TileConfig, latency: u32) -> Self {
        Self { config, latency: latency.into() }
    }
}

impl Unit for Expander {
    basrelief_kernel::role!("expands compressed tiles");
    type In = Option<EncodedTile>;
    type Out = Option<ExpandedTile>;

    fn demand(&self) -> Demand {
        Demand::All
    }

    fn step(&mut self, input: Self::In, traffic: &mut Traffic) -> Step<Self::Out> {
        let Some(EncodedTile { page, tile, bytes }) = input else { return Step::after(0, None) };
        let (first, end) = page.texels_of(tile);
        let size = [end[0] - first[0], end[1] - first[1]];
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
}
