//! Parameters that every machine has.

use crate::problem::{ConfigProblem, problem};
use basrelief_parameters::parameters;
use basrelief_shading::{Layout, TextureLayout};
use serde::{Deserialize, Serialize};

parameters! {
    /// The machine's clock. Its units count cycles; what counts seconds - memory parts, the path, the display, and times in the
    /// report - goes by it.
    pub struct ClockConfig {
        /// Cycles per second.
        hz: u64 = 200_000_000, unit: "Hz", Assumed("each machine has its own"), range: 1_u64..=100_000_000_000;
    }
}

parameters! {
    /// How textures lie in memory. The sides of blocks are powers of two; in a level smaller than a block, blocks are smaller too, down
    /// to 4 texels. Levels are padded to whole blocks.
    pub struct TextureConfig {
        /// Order of the texels of a level: linear (row by row), blocked, or blocked_6d (blocks within superblocks).
        layout: TextureLayout = TextureLayout::Blocked, unit: "", Assumed("Hakura and Gupta 1997: with blocks a texture may be crossed in any direction; Igehy, Eldridge and Proudfoot 1998 store textures in 6D blocks");
        /// Side of a block, with `blocked` and `blocked_6d`.
        block: u32 = 4, unit: "texels", Assumed("Hakura and Gupta 1997: a block is best that is a line of the cache; 4 x 4 texels of 4 bytes are one of 64"), range: 2..=64;
        /// Side of a superblock, with `blocked_6d`; no smaller than a block.
        superblock: u32 = 64, unit: "texels", Derived("Hakura and Gupta 1997: a superblock has the size of the cache; 64 x 64 texels of 4 bytes are 16 KiB"), range: 2..=1024;
    }
}

impl TextureConfig {
    /// The layout.
    pub(crate) fn layout(&self) -> Layout {
        Layout::new(self.layout, self.block, self.superblock)
    }

    /// Checks what no range can say.
    pub(crate) fn check(&self) -> Result<(), ConfigProblem> {
        for (key, side) in [("texture.block", self.block), ("texture.superblock", self.superblock)] {
            if !side.is_power_of_two() {
                return problem(key, format!("is {side}, expected a power of two"));
            }
        }
        if self.layout == TextureLayout::Blocked6d && self.superblock < self.block {
            let message = format!("is {}, but a block has a side of {}; set it to that or more", self.superblock, self.block);
            return problem("texture.superblock", message);
        }
        Ok(())
    }
}

parameters! {
    /// What costs nothing: to find what something costs.
    pub struct IdealConfig {
        /// Names of units, with commas between, whose steps keep them for one cycle and deliver as much earlier as they keep them
        /// shorter; what they ask of memories stays.
        units: String = String::new(), unit: "", Assumed("no unit is"), effect: Timing;
    }
}

parameters! {
    /// The exact picture: float64, no quantization.
    pub struct ReferenceConfig {
        /// Texture filter of the exact picture: nearest, bilinear (both on level 0) or trilinear.
        filter: ReferenceFilter = ReferenceFilter::Trilinear, unit: "", Assumed("what two-level interpolation approximates");
    }
}

/// Texture filter of the exact picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ReferenceFilter {
    /// The texel of level 0 that holds the sample point.
    Nearest,
    /// Four texels of level 0, weighted.
    Bilinear,
    /// Four texels each of two levels, by the level of detail of the pixel.
    #[default]
    Trilinear,
}
