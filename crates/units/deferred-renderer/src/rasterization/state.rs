//! What the final rasterization keeps between steps.

use crate::records::TileRecord;
use crate::texels::PageTexels;
use serde::{Deserialize, Serialize};

/// What the final rasterization waits for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Phase {
    /// A block to be coloured, or what is in front of a pass.
    #[default]
    Cells,
    /// What becomes of tiles.
    Orders,
    /// A tile of the path.
    Tile(u16, u32),
}

/// What the final rasterization has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RasterizationCounters {
    /// Pictures coloured.
    pub pictures: u64,
    /// Textured pixels coloured.
    pub textured: u64,
    /// Pixels of direct colour copied (464, 473).
    pub direct: u64,
    /// Interpolations within a layer.
    pub interpolations: u64,
    /// Interpolations between two layers.
    pub between_layers: u64,
    /// Words of the tile load lists (136) that searches read.
    pub words: u64,
    /// Most pictures of one frame.
    pub most_pictures: u64,
}

/// Everything the final rasterization remembers, with the texture-data memory (130).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RasterizationState {
    pub(super) phase: Phase,
    /// Pages and what has come of their pyramids, by number.
    pub pages: Vec<PageTexels>,
    /// Number of the current frame, from 1.
    pub frame: u64,
    /// Pictures of the current frame.
    pub pictures: u32,
    /// Centre of the frame's picture \[pixels\].
    pub centre: [u32; 2],
    /// The view is left: no picture follows the next.
    pub is_left: bool,
    /// Pixels of the pass could be better.
    pub improvable: bool,
    /// What became of tiles in frames that nobody has fetched yet, where that is kept.
    pub records: Vec<(u32, Vec<TileRecord>)>,
    /// What it has counted.
    pub counters: RasterizationCounters,
}
