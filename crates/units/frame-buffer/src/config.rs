//! Parameters of the frame buffer (126), of the pixel buffer (124) and of the video output.

use basrelief_parameters::parameters;

parameters! {
    /// Frame buffer (126).
    pub struct FrameBufferConfig {
        /// A pixel in memory.
        pixel_bytes: u32 = 4, unit: "bytes", Assumed("RGB, 8 bits each, padded to a word"), range: 1..=4;
        /// From start to delivery.
        latency: u32 = 1, unit: "cycles", Assumed("a register"), range: 0..=4096;
        /// Lines of 16 pixels that gather writes; the least recently written one goes.
        write_lines: u32 = 8, unit: "lines", Assumed("512 bytes of registers; the edge that two triangles share lies in lines that both write"), range: 1..=64;
    }
}

parameters! {
    /// Pixel buffer (124) of the rate-limited renderer.
    pub struct PixelBufferConfig {
        /// A pixel in memory.
        pixel_bytes: u32 = 4, unit: "bytes", Assumed("RGB, 8 bits each, padded to a word"), range: 1..=4;
        /// From start to delivery.
        latency: u32 = 1, unit: "cycles", Assumed("a register"), range: 0..=4096;
    }
}

parameters! {
    /// Video output.
    pub struct VideoOutConfig {
        /// Finished frames are read; off: no traffic.
        enabled: bool = true, unit: "", Assumed("a picture is looked at");
        /// Largest read.
        burst_bytes: u32 = 256, unit: "bytes", Assumed("four lines of 4 x 4 pixels"), range: 4..=65_536;
        /// Pixels that the display takes per second; 0 is as fast as the memory gives them.
        pixel_hz: u32 = 18_432_000, unit: "pixels/s", Assumed("640 x 480 pixels, 60 times a second"), range: 0..=1_000_000_000;
        /// A read may start this often, however fast the display is.
        cycles_per_read: u32 = 1, unit: "cycles", Assumed("one port"), range: 1..=1_000_000;
    }
}
