//! Parameters of the frame buffer (126), of the pixel buffer (124) and of the video output.

use basrelief_parameters::parameters;

parameters! {
    /// Frame buffer (126).
    pub struct FrameBufferConfig {
        /// Size of a pixel in memory.
        pixel_bytes: u32 = 4, unit: "bytes", Assumed("RGB, 8 bits each, padded to a word; 3 bytes hold it"), range: 3..=4;
        /// Latency of a step.
        latency: u32 = 1, unit: "cycles", Assumed("a register"), range: 0..=4096;
        /// Lines of 16 pixels that gather writes. The least recently written one is evicted.
        write_lines: u32 = 8, unit: "lines", Assumed("512 bytes of registers; the edge that two triangles share lies in lines that both write"), range: 1..=64;
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

parameters! {
    /// Video output.
    pub struct VideoOutConfig {
        /// True if finished frames are read. False: no traffic.
        enabled: bool = true, unit: "", Assumed("a picture is looked at");
        /// Largest read.
        burst_bytes: u32 = 256, unit: "bytes", Assumed("four lines of 4 x 4 pixels"), range: 4..=65_536;
        /// Pixel rate of the display. 0 reads as fast as memory allows.
        pixel_hz: u32 = 18_432_000, unit: "pixels/s", Assumed("640 x 480 pixels, 60 times a second"), range: 0..=1_000_000_000;
        /// Fewest cycles between the starts of two reads, however fast the display is.
        cycles_per_read: u32 = 1, unit: "cycles", Assumed("one port"), range: 1..=1_000_000;
    }
}
