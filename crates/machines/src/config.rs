//! Parameters of every machine.

use crate::problem::{ConfigProblem, problem};
use basrelief_parameters::parameters;
use basrelief_shading::{BlockLayout, TextureLayout};
use serde::{Deserialize, Serialize};

parameters! {
    /// Clock of the machine. Units count cycles. Memory parts, the path, the display, and times in the report are converted with it.
    pub struct ClockConfig {
        /// Clock frequency.
        hz: u64 = 200_000_000, unit: "Hz", Assumed("each machine has its own"), range: 1_u64..=100_000_000_000;
    }
}

/// Old names of parameters, each with its new name. A parameter without a new name has no effect.
pub(crate) const RENAMED: &[(&str, &str)] = &[
    ("video_out.enabled", "display.enabled"),
    ("video_out.burst_bytes", "display.burst_bytes"),
    ("video_out.pixel_hz", "display.pixel_hz"),
    ("video_out.cycles_per_read", ""),
    ("combiner.pixel_bytes", "frame_buffer.pixel_bytes"),
    ("fifo.finished_frames.depth", ""),
    ("fifo.finished_frames.latency", ""),
];

parameters! {
    /// Layout of textures in memory. The sides of blocks are powers of two. In a level smaller than a block, blocks are smaller, down to 4
    /// texels. Levels are padded to whole blocks.
    pub struct TextureConfig {
        /// Order of the texels of a level: linear (row by row), blocked, or blocked_6d (blocks within superblocks).
        layout: TextureLayout = TextureLayout::Blocked, unit: "", Assumed("Hakura and Gupta 1997: blocks suit any direction of access to a texture; Igehy, Eldridge and Proudfoot 1998 store textures in 6D blocks");
        /// Side of a block, with `blocked` and `blocked_6d`.
        block: u32 = 4, unit: "texels", Assumed("Hakura and Gupta 1997: the best block is a cache line; 4 x 4 texels of 4 bytes are 64 bytes"), range: 2..=64;
        /// Side of a superblock, with `blocked_6d`; at least the side of a block.
        superblock: u32 = 64, unit: "texels", Derived("Hakura and Gupta 1997: a superblock has the size of the cache; 64 x 64 texels of 4 bytes are 16 KiB"), range: 2..=1024;
    }
}

impl TextureConfig {
    /// Returns the layout.
    pub(crate) fn layout(&self) -> BlockLayout {
        BlockLayout::new(self.layout, self.block, self.superblock)
    }

    /// Checks that the parameters fit together.
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
    /// Idealized units, to measure how much a unit costs.
    pub struct IdealConfig {
        /// Comma-separated names of units that are fully pipelined (initiation interval 1). Their latency shrinks by the same number of
        /// cycles. Their memory requests stay.
        units: String = String::new(), unit: "", Assumed("none by default"), effect: Timing;
    }
}

parameters! {
    /// Reference image, in float64 and without quantization.
    pub struct ReferenceConfig {
        /// Texture filter of the reference image: nearest, bilinear (both on level 0) or trilinear.
        filter: ReferenceFilter = ReferenceFilter::Trilinear, unit: "", Assumed("two-level interpolation approximates it");
    }
}

/// Texture filter of the reference image.
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
