//! All parameters of the texture mapping system, in the order of its block diagram, and its FIFOs.

use crate::config::{ClockConfig, IdealConfig, TextureConfig};
use crate::fifos::fifos;
use crate::front::front_of;
use crate::memories::{complete, explain, memories, memories_of};
use basrelief_frame_buffer::{FrameBufferConfig, FrameDone, VideoOutConfig};
use basrelief_geometry_processor::{BumpConfig, DisplayListConfig, GeometryConfig};
use basrelief_graphics_processor::DepthConfig;
use basrelief_kernel::{CacheConfig, MemoryConfig, MemoryPart, OperatorConfig, Operators};
use basrelief_parameters::{parameter_groups, parameters};
use basrelief_signals::{Control, Draw, Flow, LightingStage, PixelPacket, VertexAttributes};
use basrelief_texel_value_generator::signals::{
    GradientPacket, IlluminancePacket, LevelPacket, LitSpan, Points, Quotients, Segment, Span, TexelPacket, TexturePacket,
};
use basrelief_texel_value_generator::{
    ApproximationConfig, CombinerConfig, DividerConfig, IlluminanceConfig, IlluminanceMode, LookUpConfig, MipConfig,
    ScanConverterConfig, TexelConfig,
};

parameters! {
    /// Pixel value buffer (360).
    pub struct PixelValueBufferConfig {
        /// Pixels are tested for depth; off: the last one drawn stays.
        depth_test: bool = true, unit: "", Assumed("the patent has none; polygons would have to come sorted");
    }
}

/// Cycles per second, by default.
const HZ: u64 = 50_000_000;

/// A board of the time: 128 bits.
fn board(outstanding: u32) -> MemoryConfig {
    let part = MemoryPart::Edo60;
    MemoryConfig { part, window: 4, cap: 4, outstanding, ..MemoryConfig::default() }
}

memories! {
    /// The three memories.
    pub struct MemoryConfigs at HZ {
        /// Memory of the texture look-up table (330). Its port has the credits of the largest step: four texels of each of two
        /// levels for each of 16 pixels.
        texture = board(128) => [
            part: Assumed("1994: EDO came in that year and was in every board of the next, which is when a device of this patent could have been built; 80 ns page mode is `fpm-80`"),
            channels: Assumed("128 bits side by side: a line of 64 bytes is a burst of four page cycles"),
            window: Assumed("an arbiter that looks at the head of each port, and prefers the open page"),
            cap: Assumed("one turn of the ports"),
            outstanding: Assumed("the largest step: 4 texels of 2 levels for 16 pixels"),
        ],
        /// Depth values. The patent has none, so they have a memory of their own: in that of (360) they would keep it from its
        /// rows.
        depth = board(16) => [
            part: Assumed("as the texture memory"),
            channels: Assumed("12.8 bytes per cycle, of which a pixel with depth takes 8"),
            window: Assumed("an arbiter that looks at the head of each port, and prefers the open page"),
            cap: Assumed("one turn of the ports"),
            outstanding: Assumed("more than a page miss of 60 ns DRAM takes at one request per cycle"),
        ],
        /// Pixel value buffer (360).
        pixel = board(16) => [
            part: Assumed("as the texture memory"),
            channels: Assumed("12.8 bytes per cycle, of which a pixel takes 4, or 8 where it is read back"),
            window: Assumed("an arbiter that looks at the head of each port, and prefers the open page"),
            cap: Assumed("one turn of the ports"),
            outstanding: Assumed("more than a page miss of 60 ns DRAM takes at one request per cycle"),
        ],
    }
}

parameter_groups! {
    /// The caches.
    pub struct CacheConfigs {
        /// Texels, in the texture look-up table (330).
        texture: CacheConfig = CacheConfig::default(),
        /// Depth values, for the depth test.
        depth: CacheConfig = CacheConfig { sets: 32, lookups_per_cycle: 1, ..CacheConfig::default() },
    }
}

fifos! {
    /// FIFOs of the texture mapping system, by name. Defaults hold full rate (law 2): latency of the producer + FIFO latency
    /// + 1, and on the way out of a unit that waits for memory its loaded latency too.
    pub struct FifoConfigs, Fifos {
        /// Host to geometry processor: triangles.
        draws: Draw = 16,
        /// Geometry processor to scan converter: the display list.
        polygons: Control = 32,
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
        /// Pixel value buffer (360) to DACs (370): finished frames, as many as wait for the
        /// display while drawing goes on.
        finished_frames: FrameDone = 256,
    }
}

parameter_groups! {
    /// All parameters of the texture mapping system.
    pub struct TexelMachineConfig completed(complete) explained(explain) {
        /// Clock.
        clock: ClockConfig = ClockConfig { hz: HZ } => [
            hz: Assumed("1994: what workstations of its maker ran their buses and boards at (SPARCstation 20: MBus of 50 MHz)"),
        ],
        /// Operators: how long arithmetic takes, the same in every unit.
        operators: Operators = Operators {
            multiply: OperatorConfig::new(3, 1),
            add: OperatorConfig::new(3, 1),
            divide: OperatorConfig::new(16, 16),
            square_root: OperatorConfig::new(16, 16),
            power: OperatorConfig::new(64, 64),
        } => [
            multiply.latency: Assumed("SuperSPARC (1992), of the same maker: FMUL 3 cycles"),
            multiply.interval: Assumed("the same, pipelined"),
            add.latency: Assumed("the same processor: FADD 3 cycles"),
            add.interval: Assumed("the same, pipelined"),
            divide.latency: Assumed("an iterative divider of 32 bits, two bits a cycle"),
            divide.interval: Assumed("the same, not pipelined"),
            square_root.latency: Assumed("an iterative root of 32 bits, two bits a cycle"),
            square_root.interval: Assumed("the same, not pipelined"),
            power.latency: Assumed("logarithm, product, exponential by iteration of 32 bits, a bit a cycle each"),
            power.interval: Assumed("the same, not pipelined"),
        ],
        /// How a display list is fed.
        display_list: DisplayListConfig = DisplayListConfig::default(),
        /// Which polygons a display list marks as bump targets, for the machine that knows them; this one lights them itself.
        bump: BumpConfig = BumpConfig::default(),
        /// Geometry processor.
        geometry: GeometryConfig = GeometryConfig { fetch_bytes_per_cycle: 8, link_bytes: 8, ..GeometryConfig::default() } => [
            fetch_bytes_per_cycle: Assumed("64 bits per cycle at 50 MHz, of the class of the MBus of the same maker's workstations"),
            link_bytes: Assumed("as wide as the bus that vertices come by"),
        ],
        /// Scan converter.
        scan: ScanConverterConfig = ScanConverterConfig::default(),
        /// Texel value generator (310): division points.
        texel: TexelConfig = TexelConfig::default(),
        /// Its dividers.
        divider: DividerConfig = DividerConfig::default(),
        /// Its approximate calculator (310a).
        approximation: ApproximationConfig = ApproximationConfig::default(),
        /// MIP-map selector (320).
        mip: MipConfig = MipConfig::default(),
        /// Texture look-up table (330).
        look_up: LookUpConfig = LookUpConfig::default(),
        /// Textures in the memory of (330).
        texture: TextureConfig = TextureConfig::default(),
        /// Illuminance value generator (340).
        illuminance: IlluminanceConfig = IlluminanceConfig::default(),
        /// Combiner (350).
        combiner: CombinerConfig = CombinerConfig::default(),
        /// Pixel value buffer (360).
        pixel_value_buffer: PixelValueBufferConfig = PixelValueBufferConfig::default(),
        /// Depth test.
        depth: DepthConfig = DepthConfig::default(),
        /// Write port of the pixel value buffer (360).
        frame_buffer: FrameBufferConfig = FrameBufferConfig::default(),
        /// DACs (370).
        video_out: VideoOutConfig = VideoOutConfig::default(),
        /// FIFOs.
        fifo: FifoConfigs = FifoConfigs::default(),
        /// Memories.
        memory: MemoryConfigs = MemoryConfigs::default(),
        /// Caches.
        cache: CacheConfigs = CacheConfigs::default(),
        /// What costs nothing.
        ideal: IdealConfig = IdealConfig::default(),
    }
}

front_of!(TexelMachineConfig, |c| VertexAttributes { lit: lit(c), normal_maps: false, textures: true });
memories_of!(TexelMachineConfig);

/// Vertices are lit where brightness is interpolated, those of bump targets in (340).
fn lit(c: &TexelMachineConfig) -> LightingStage {
    match c.illuminance.mode {
        IlluminanceMode::Off => LightingStage::Nowhere,
        IlluminanceMode::Gouraud => LightingStage::Targets,
    }
}
