//! State of the final rasterization between steps.

use crate::records::TileRecord;
use crate::texels::PageTexels;
use serde::{Deserialize, Serialize};

/// Input that the final rasterization waits for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum RasterizationPhase {
    /// A block to be coloured, or a token before a pass.
    #[default]
    Cells,
    /// Orders for tiles.
    Orders,
    /// This tile from the path.
    Tile(u16, u32),
}

/// Counters of the final rasterization.
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
    /// Maximum number of pictures of one frame.
    pub most_pictures: u64,
}

/// State of the final rasterization, with the texture-data memory (130).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RasterizationState {
    pub(super) phase: RasterizationPhase,
    /// Pages and the received parts of their pyramids, by number.
    pub pages: Vec<PageTexels>,
    /// Number of the current frame, from 1.
    pub frame: u64,
    /// Pictures of the current frame.
    pub pictures: u32,
    /// Centre of the frame's picture \[pixels\].
    pub centre: [u32; 2],
    /// True if the view is left: no picture follows the next.
    pub is_left: bool,
    /// True if pixels of the pass could be improved.
    pub improvable: bool,
    /// Tile records of frames that are not fetched yet, if recording is enabled.
    pub records: Vec<(u32, Vec<TileRecord>)>,
    /// Counters.
    pub counters: RasterizationCounters,
}
