//! Parameters of the rasterizer.

use basrelief_kernel::OperatorCounts;
use basrelief_parameters::parameters;
use basrelief_shading::RasterGrid;
use serde::{Deserialize, Serialize};

/// Order in which the pixels of a triangle are visited.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RasterOrder {
    /// Square blocks, row by row. Each block is visited row by row.
    #[default]
    Tiled,
    /// Row by row.
    Rows,
    /// Column by column.
    Columns,
}

parameters! {
    /// Rasterizer.
    pub struct RasterizerConfig {
        /// Sub-pixel bits n: window coordinates are snapped to steps of 2^-n pixel.
        subpixel_bits: u32 = 8, unit: "bits", Assumed("eight bits are common in graphics hardware"), range: 1..=10;
        /// Order in which the pixels of a triangle are visited: tiled, rows or columns.
        order: RasterOrder = RasterOrder::Tiled, unit: "", Assumed("Hakura and Gupta 1997: the working set of a texture is smaller in tiles than along long rows");
        /// Side of the square blocks in which `tiled` order visits a triangle, row by row.
        block: u32 = 4, unit: "pixels", Assumed("the block of the texture and buffer layouts, so that a line is finished before the next"), range: 1..=8;
        /// Most fragments of a stamp (one token): covered pixels of one 4 x 4 block, in order. The stamp size does not change
        /// their rate.
        stamp: u32 = 4, unit: "fragments", Assumed("neighbours share memory lines, so their look-ups are made once; whole blocks would need tokens four times as wide"), range: 1..=4;
        /// Width of depth values.
        z_bits: u32 = 24, unit: "bits", Assumed("common; 16 shows z-fighting, 32 costs traffic"), range: 16..=32;
        /// True if the z-test follows the rasterizer, false if it precedes the frame buffer.
        early_z: bool = true, unit: "", Assumed("hidden fragments then cost no search; nothing behind the rasterizer discards fragments");
        /// Multipliers of the unit.
        multipliers: u32 = 8, unit: "operators", Assumed("a fragment takes eight: depth, perspective, weights; a set-up takes twelve, so that a triangle is set up in two cycles, and the link brings none faster"), range: 1..=256;
        /// Adders of the unit.
        adders: u32 = 11, unit: "operators", Assumed("a fragment takes eleven: steps and signs of three edge functions, depth, sum of the weights"), range: 1..=256;
        /// Dividers of the unit. Each fragment needs a reciprocal.
        dividers: u32 = 7, unit: "operators", Assumed("one fragment per cycle with divisions of 7 cycles that are not pipelined: they take turns"), range: 1..=256;
    }
}

impl RasterizerConfig {
    /// Returns the raster of a screen of this size.
    pub(crate) fn raster(&self, screen: [u32; 2]) -> RasterGrid {
        let block = if self.order == RasterOrder::Tiled { self.block } else { 1 };
        let raster = RasterGrid::new(screen, self.subpixel_bits, self.z_bits, block);
        RasterGrid { columns: self.order == RasterOrder::Columns, ..raster }
    }

    /// Returns the unit's operators.
    pub fn operators(&self) -> OperatorCounts {
        OperatorCounts { multiply: self.multipliers, add: self.adders, divide: self.dividers, ..OperatorCounts::NONE }
    }
}
