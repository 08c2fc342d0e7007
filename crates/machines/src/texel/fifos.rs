//! The FIFOs of the machine.

use crate::fifos::fifos;
use basrelief_frame_buffer::FrameDone;
use basrelief_signals::{Control, Draw, Flow, PixelPacket};
use basrelief_texel_value_generator::signals::{
    GradientPacket, IlluminancePacket, LevelPacket, LitSpan, Points, Quotients, Segment, Span, TexelPacket, TexturePacket,
};

fifos! {
    /// FIFOs of the texture mapping system, by name. Defaults hold full rate (law 2): latency of the producer + FIFO latency
    /// + 1, and on the way out of a unit that waits for memory its loaded latency too.
    pub struct FifoConfigs, Fifos {
        /// Host to geometry processor: triangles.
        draws: Draw = 16,
        /// Geometry processor to scan converter: the display list.
        polygons: Control = 16,
        /// Scan converter to step calculator: scan lines of triangles.
        spans: Flow<Span> = 8,
        /// Scan converter to illuminance value generator (340): the same, with other values. Holds what is under way on the
        /// other way.
        lit_spans: Flow<LitSpan> = 64,
        /// Step calculator to dividers: points.
        points: Flow<Points> = 4,
        /// Step calculator to approximate calculator (310a): segments. Holds what is being divided.
        segments: Flow<Segment> = 8,
        /// Dividers to approximate calculator (310a): exact values. So many divisions are ahead of the interpolation.
        quotients: Flow<Quotients> = 4,
        /// Approximate calculator (310a) to depth test, or to texture look-up table (330) without it.
        texels: Flow<TexelPacket> = 16,
        /// Approximate calculator (310a) to MIP-map selector (320).
        gradients: Flow<GradientPacket> = 16,
        /// Depth test to texture look-up table (330).
        tested_texels: Flow<TexelPacket> = 64,
        /// MIP-map selector (320) to texture look-up table (330): map select.
        levels: Flow<LevelPacket> = 64,
        /// Texture look-up table (330) to combiner (350).
        texture_values: Flow<TexturePacket> = 64,
        /// Illuminance value generator (340) to combiner (350). Holds what is under way on the other way.
        illuminances: Flow<IlluminancePacket> = 64,
        /// Combiner (350) to pixel value buffer (360).
        pixels: Flow<PixelPacket> = 64,
        /// Pixel value buffer (360) to DACs (370): finished frames, as many as wait for the display
        /// while drawing goes on.
        finished_frames: FrameDone = 256,
    }
}
