//! Parameters of the frame buffer (126), of the pixel buffer (124) and of the display.

use basrelief_parameters::parameters;
use serde::{Deserialize, Serialize};

parameters! {
    /// Frame buffer (126).
    pub struct FrameBufferConfig {
        /// Size of a pixel in memory.
        pixel_bytes: u32 = 4, unit: "bytes", Assumed("RGB, 8 bits each, padded to a word; 3 bytes hold it"), range: 3..=4;
        /// Latency of a step.
        latency: u32 = 1, unit: "cycles", Assumed("a register"), range: 0..=4096;
        /// Lines of 16 pixels that gather writes. The least recently written one is evicted.
        write_lines: u32 = 8, unit: "lines", Assumed("512 bytes of registers; the edge that two triangles share lies in lines that both write"), range: 1..=64;
        /// True if each line has a flag for "not drawn in this frame". The end of the frame clears the flagged lines. False: the
        /// beginning of the frame clears all lines.
        clear_flags: bool = true, unit: "", Assumed("a bit per line of 16 pixels spares the clearing of lines that are drawn");
        /// Number of flags. The beginning of the frame clears the lines of a larger image beyond the last flag.
        flags: u32 = 131_072, unit: "bits", Assumed("16 KB: images of 2 million pixels, 1600 x 1200 and a little more"), range: 1..=16_777_216;
        /// Flags that are set or examined in a cycle.
        flags_per_cycle: u32 = 64, unit: "bits", Assumed("a word of the memory of the flags"), range: 1..=65_536;
    }
}

parameters! {
    /// Pixel buffer (124) of the rate-limited renderer.
    pub struct PixelBufferConfig {
        /// Size of a pixel in memory.
        pixel_bytes: u32 = 4, unit: "bytes", Assumed("RGB, 8 bits each, padded to a word; 3 bytes hold it"), range: 3..=4;
        /// Latency of a step.
        latency: u32 = 1, unit: "cycles", Assumed("a register"), range: 0..=4096;
    }
}

/// Time at which the display flips to a finished frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DisplayMode {
    /// At once. A refresh may show parts of two frames (tearing).
    #[default]
    Immediate,
    /// At the beginning of the next refresh, one frame per refresh (vertical synchronization).
    Fifo,
}

parameters! {
    /// Display, with its swap chain of colour buffers.
    pub struct DisplayConfig {
        /// True if the display reads the front buffer. False: no traffic, and buffers are free at once.
        enabled: bool = true, unit: "", Assumed("a user looks at the images"), effect: Timing;
        /// Colour buffers of the swap chain. Drawing of a frame waits for a free one.
        buffers: u32 = 2, unit: "buffers", Assumed("double buffering"), range: 2..=8;
        /// Time of a flip: immediate or fifo.
        mode: DisplayMode = DisplayMode::Immediate, unit: "", Assumed("a run measures the speed of the device; with fifo, all devices that draw a frame in one refresh take equal cycles"), effect: Timing;
        /// Pixel rate of the display.
        pixel_hz: u32 = 18_432_000, unit: "pixels/s", Assumed("640 x 480 pixels, 60 times a second"), range: 1..=1_000_000_000, effect: Timing;
        /// Refresh rate of the display. A refresh reads `pixel_hz` / `refresh_hz` pixels of the front buffer.
        refresh_hz: u32 = 60, unit: "Hz", Assumed("a monitor of the time"), range: 1..=100_000, effect: Timing;
        /// Bytes of a read. The display shows the bytes of one read while it fetches those of the next.
        burst_bytes: u32 = 256, unit: "bytes", Assumed("four lines of 4 x 4 pixels"), range: 4..=65_536, effect: Timing;
    }
}
