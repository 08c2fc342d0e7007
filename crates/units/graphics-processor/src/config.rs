//! Parameters of the graphics processor (104) and of the z-test.

use basrelief_parameters::parameters;
use basrelief_signals::Filter;
use serde::{Deserialize, Serialize};

/// When a list is drawn (S24 of Figure 4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DrawOrder {
    /// Each fragment as soon as it is shaded.
    #[default]
    Streamed,
    /// All, when every bump target of the frame is shaded; results wait in the graphics-data memory (124).
    AfterList,
}

/// Choice of the colour texture's MIP level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Mip {
    /// The level nearest to the polygon's own level of detail for this texture.
    #[default]
    Nearest,
    /// Always the finest.
    Off,
}

parameters! {
    /// Graphics processor (104).
    pub struct GraphicsConfig {
        /// When a list is drawn: streamed or after_list.
        draw: DrawOrder = DrawOrder::Streamed, unit: "", Assumed("the flow chart draws after all bump targets (S24); streaming gives the same picture without holding results");
        /// Filter within a level of the colour texture: nearest or bilinear.
        filter: Filter = Filter::Bilinear, unit: "", Assumed("ordinary texture mapping; four taps");
        /// MIP level of the colour texture: nearest or off.
        mip: Mip = Mip::Nearest, unit: "", Assumed("one level, chosen once per polygon");
        /// A texel of a colour texture.
        texel_bytes: u32 = 4, unit: "bytes", Assumed("RGBA, 8 bits each"), range: 1..=16;
        /// The unit is kept this long by each pixel.
        blend_cycles: u32 = 1, unit: "cycles", Assumed("one pixel per cycle"), range: 1..=1024;
        /// From start to delivery, texture in the cache.
        latency: u32 = 8, unit: "cycles", Assumed("addressing, filter and multiplication"), range: 0..=4096;
        /// A result that waits to be drawn: place, depth, texture coordinates, brightness.
        held_bytes: u32 = 16, unit: "bytes", Assumed("x, y 16 bits each, z 24, u, v 24 each, brightness 8, highlight 8, padded"), range: 1..=256;
        /// Room for the results of one frame when `draw` is after_list.
        hold_bytes: u32 = 67_108_864, unit: "bytes", Assumed("13 layers of 640 x 480"), range: 1..=1_073_741_824;
    }
}

parameters! {
    /// Z-test, with the z-buffer in the graphics-data memory (124).
    pub struct DepthConfig {
        /// From start to delivery, z in the cache.
        latency: u32 = 2, unit: "cycles", Assumed("one comparison"), range: 0..=4096;
        /// Lines of 16 pixels that gather writes; the least recently written one goes.
        write_lines: u32 = 8, unit: "lines", Assumed("512 bytes of registers; the edge that two triangles share lies in lines that both write"), range: 1..=64;
        /// A flag per line says that nothing was written to it since the fast clear: it is not read.
        clear_flags: bool = true, unit: "", Assumed("a fast clear that moves no data has to be kept somewhere: a bit per line of 16 pixels");
    }
}
