//! Parameters of the graphics processor (104) and of the z-test.

use basrelief_kernel::OperatorCounts;
use basrelief_parameters::parameters;
use basrelief_signals::TexelFilter;
use serde::{Deserialize, Serialize};

/// Time at which a list is drawn (S24 of Figure 4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DrawOrder {
    /// Each fragment as soon as it is shaded.
    #[default]
    Streamed,
    /// All fragments, after every bump target of the frame is shaded. Their entries wait in the graphics-data memory (124).
    AfterList,
}

/// Entry per fragment of a bump target that is stored on the surface until the list is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum HeldEntry {
    /// Brightness, looked up and interpolated (S20, S22).
    #[default]
    Brightness,
    /// Indexes of reference normals (S18), one per level, which are looked up when the list is drawn.
    Index,
    /// Pseudo-normals N' (S16), one per level, which the indexes exist to avoid.
    Normal,
}

/// Choice of the colour texture's MIP level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MipFilter {
    /// The level nearest to the polygon's own level of detail for this texture.
    #[default]
    Nearest,
    /// The finest level, always.
    Off,
}

parameters! {
    /// Graphics processor (104).
    pub struct GraphicsConfig {
        /// Time at which a list is drawn: streamed or after_list.
        draw: DrawOrder = DrawOrder::Streamed, unit: "", Assumed("the flow chart draws after all bump targets (S24); streaming gives the same image without holding results");
        /// Filter within a level of the colour texture: nearest or bilinear.
        filter: TexelFilter = TexelFilter::Bilinear, unit: "", Assumed("ordinary texture mapping; four taps");
        /// MIP level of the colour texture: nearest or off.
        mip: MipFilter = MipFilter::Nearest, unit: "", Assumed("one level, chosen once per polygon");
        /// Size of a texel of a colour texture.
        texel_bytes: u32 = 4, unit: "bytes", Assumed("RGBA, 8 bits each; RGB is used"), range: 3..=16;
        /// Multipliers of the unit.
        multipliers: u32 = 41, unit: "operators", Assumed("one pixel per cycle of every kind: texture, vertex colours, brightness at the vertices"), range: 1..=1024;
        /// Adders of the unit.
        adders: u32 = 38, unit: "operators", Assumed("the same pixel"), range: 1..=1024;
        /// Stored entry per fragment of a bump target if `draw` is after_list: brightness, index or normal.
        held: HeldEntry = HeldEntry::Brightness, unit: "", Stated("Figure 4: S22 is done for all bump targets before S24 draws; the surface then has the brightness map of Figure 5");
        /// Most fragments of one frame that can wait if `draw` is after_list. Those of bump targets have an entry each. The
        /// others are found again in the display list.
        hold_fragments: u32 = 4_194_304, unit: "fragments", Assumed("13 layers of 640 x 480"), range: 1..=67_108_864;
    }
}

impl GraphicsConfig {
    /// Returns the unit's operators.
    pub fn operators(&self) -> OperatorCounts {
        OperatorCounts { multiply: self.multipliers, add: self.adders, ..OperatorCounts::NONE }
    }
}

parameters! {
    /// Z-test, with the z-buffer in the graphics-data memory (124).
    pub struct DepthConfig {
        /// Lines of 16 pixels that gather writes. The least recently written one is evicted.
        write_lines: u32 = 8, unit: "lines", Assumed("512 bytes of registers; the edge that two triangles share lies in lines that both write"), range: 1..=64;
        /// True if each line has a flag for "not written since the fast clear". A flagged line is not read. False: the beginning of the
        /// frame clears all lines by writes.
        clear_flags: bool = true, unit: "", Assumed("a fast clear that moves no data has to be kept somewhere: a bit per line of 16 pixels");
        /// Number of flags. The beginning of the frame clears the lines of a larger image beyond the last flag.
        flags: u32 = 131_072, unit: "bits", Assumed("16 KB: images of 2 million pixels, 1600 x 1200 and a little more"), range: 1..=16_777_216;
        /// Flags that are set in a cycle.
        flags_per_cycle: u32 = 64, unit: "bits", Assumed("a word of the memory of the flags"), range: 1..=65_536;
        /// Cycles that the look-up of a flag takes before the look-up of the depth value.
        flag_latency: u32 = 0, unit: "cycles", Derived("the flags are addressed by the number of the line, which also addresses the tags of the z-cache: both are read in the cycle of the look-up, and the flag discards its result"), range: 0..=4096;
    }
}
