//! Parameters of the rasterizer.

use basrelief_parameters::parameters;

parameters! {
    /// Rasterizer.
    pub struct RasterizerConfig {
        /// Window coordinates are snapped to steps of 2^-n pixel.
        subpixel_bits: u32 = 8, unit: "bits", Assumed("eight bits are what graphics hardware has in common"), range: 1..=10;
        /// Side of the square blocks in which a triangle is visited, row of blocks by row of blocks.
        block: u32 = 4, unit: "pixels", Assumed("the block of the texture and buffer layouts, so that a line is finished before the next"), range: 1..=8;
        /// Most fragments of a stamp, which is a token: covered pixels of one 4 x 4 block, in order. One leaves per cycle
        /// whatever the stamp.
        stamp: u32 = 4, unit: "fragments", Assumed("neighbours share memory lines, so their look-ups are made once; whole blocks would need tokens four times as wide"), range: 1..=4;
        /// Depth values.
        z_bits: u32 = 24, unit: "bits", Assumed("common; 16 shows z-fighting, 32 costs traffic"), range: 16..=32;
        /// The z-test stands behind the rasterizer rather than in front of the frame buffer.
        early_z: bool = true, unit: "", Assumed("hidden fragments then cost no search; nothing behind the rasterizer discards fragments");
        /// The unit is kept this long by each triangle of a polygon's fan, before its fragments.
        setup_cycles: u32 = 1, unit: "cycles", Assumed("pipelined set-up of one triangle per cycle"), range: 0..=1024;
        /// From start to delivery.
        latency: u32 = 8, unit: "cycles", Assumed("edge functions, spans and one division"), range: 0..=4096;
    }
}
