//! All parameters of the texture mapping system, in the order of its block diagram, and its FIFOs.

use crate::config::{ClockConfig, IdealConfig, TextureConfig};
use crate::display::SwapChain;
use crate::fifos::fifos;
use crate::front::front_of;
use crate::memories::{complete, explain, memories, memories_of};
use basrelief_frame_buffer::{DisplayConfig, FrameBufferConfig};
use basrelief_geometry_processor::{BumpConfig, DisplayListConfig, GeometryConfig};
use basrelief_graphics_processor::DepthConfig;
use basrelief_kernel::{AreaConfig, CacheConfig, MemoryConfig, MemoryPart, OperatorConfig, Operators};
use basrelief_parameters::{parameter_groups, parameters};
use basrelief_signals::{Control, Draw, Flow, LightingStage, PixelPacket, VertexAttributes};
use basrelief_texel_value_generator::signals::{
    DivisionPoints, GradientPacket, IlluminancePacket, LevelPacket, LineSegment, LitSpan, Quotients, ScanSpan, TexelPacket,
    TexturePacket,
};
use basrelief_texel_value_generator::{
    ApproximationConfig, CombinerConfig, DividerConfig, IlluminanceConfig, IlluminanceMode, LookUpConfig, MipConfig,
    ScanConverterConfig, TexelConfig,
};

parameters! {
    /// Pixel value buffer (360).
    pub struct PixelValueBufferConfig {
        /// True if pixels are tested for depth. Otherwise, later pixels replace earlier ones.
        depth_test: bool = true, unit: "", Assumed("the patent has none; polygons would have to come sorted");
    }
}

/// Default clock \[Hz\].
const HZ: u64 = 50_000_000;

/// Memory of a graphics board of the time, 128 bits wide.
fn board(outstanding: u32) -> MemoryConfig {
    let part = MemoryPart::Edo60;
    MemoryConfig { part, cap: 4, outstanding, ..MemoryConfig::default() }
}

memories! {
    /// Memories.
    pub struct MemoryConfigs at HZ {
        /// Memory of the texture look-up table (330). Its port has credits for the largest step: four texels of each of two levels for
        /// each of 16 pixels.
        texture = board(128) => [
            part: Assumed("1994: EDO appeared in that year and was on every board in the next one, when a device of this patent could have been built; 80 ns page mode is `fpm-80`"),
            channels: Assumed("128 bits wide: a line of 64 bytes is a burst of four page cycles"),
            cap: Assumed("one turn of the ports"),
            outstanding: Assumed("the largest step: 4 texels of 2 levels for 16 pixels"),
        ],
        /// Depth values. The patent has no depth test, so depth values have a separate memory. In the memory of (360) they would cause
        /// additional row misses.
        depth = board(16) => [
            part: Assumed("as the texture memory"),
            channels: Assumed("12.8 bytes per cycle, of which a pixel with depth takes 8"),
            cap: Assumed("one turn of the ports"),
            outstanding: Assumed("more than a page miss of 60 ns DRAM takes at one request per cycle"),
        ],
        /// Pixel value buffer (360).
        pixel = board(16) => [
            part: Assumed("as the texture memory"),
            channels: Assumed("12.8 bytes per cycle, of which a pixel takes 4, or 8 where it is read back"),
            cap: Assumed("one turn of the ports"),
            outstanding: Assumed("more than a page miss of 60 ns DRAM takes at one request per cycle"),
        ],
    }
}

parameter_groups! {
    /// Caches.
    pub struct CacheConfigs {
        /// Texels, in the texture look-up table (330).
        texture: CacheConfig = CacheConfig::default(),
        /// Depth values, for the depth test.
        depth: CacheConfig = CacheConfig { sets: 32, lookups_per_cycle: 1, ..CacheConfig::default() },
    }
}

fifos! {
    /// FIFOs of the texture mapping system, by name. Default depths sustain full throughput (law 2): latency of the producer + FIFO
    /// latency + 1, plus the loaded memory latency after a unit that waits for memory.
    pub struct FifoConfigs, Fifos {
        /// Host to geometry processor: triangles.
        draws: Draw = 16,
        /// Geometry processor to scan converter: the display list.
        polygons: Control = 32,
        /// Scan converter to step calculator: scan lines of triangles.
        spans: Flow<ScanSpan> = 8,
        /// Scan converter to illuminance value generator (340): scan lines with brightness. Covers the latency of the texture path.
        lit_spans: Flow<LitSpan> = 64,
        /// Step calculator to dividers: points.
        points: Flow<DivisionPoints> = 4,
        /// Step calculator to approximate calculator (310a): segments. Covers the latency of the dividers.
        segments: Flow<LineSegment> = 8,
        /// Dividers to approximate calculator (310a): exact values. The depth is the number of divisions ahead of the interpolation.
        quotients: Flow<Quotients> = 4,
        /// Approximate calculator (310a) to depth test, or to texture look-up table (330) without a depth test: texel coordinates.
        texels: Flow<TexelPacket> = 16,
        /// Approximate calculator (310a) to MIP-map selector (320): gradients.
        gradients: Flow<GradientPacket> = 16,
        /// Depth test to texture look-up table (330): texel coordinates.
        tested_texels: Flow<TexelPacket> = 64,
        /// MIP-map selector (320) to texture look-up table (330): map select.
        levels: Flow<LevelPacket> = 64,
        /// Texture look-up table (330) to combiner (350): texture values.
        texture_values: Flow<TexturePacket> = 64,
        /// Illuminance value generator (340) to combiner (350): illuminance values. Covers the latency of the texture path.
        illuminances: Flow<IlluminancePacket> = 64,
        /// Combiner (350) to pixel value buffer (360): pixels.
        pixels: Flow<PixelPacket> = 64,
    }
}

parameter_groups! {
    /// All parameters of the texture mapping system.
    pub struct TexelMachineConfig completed(complete) explained(explain) renamed(crate::config::RENAMED) {
        /// Clock.
        clock: ClockConfig = ClockConfig { hz: HZ } => [
            hz: Assumed("1994: clock of buses and boards in workstations of its maker (SPARCstation 20: MBus of 50 MHz)"),
        ],
        /// Latency and initiation interval of arithmetic operators, the same in every unit.
        operators: Operators = Operators {
            multiply: OperatorConfig::new(3, 1),
            add: OperatorConfig::new(3, 1),
            divide: OperatorConfig::new(16, 16),
            square_root: OperatorConfig::new(16, 16),
            power: OperatorConfig::new(64, 64),
            ..Operators::default()
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
            integer_multiply.latency: Assumed("a product of 16 bits takes 69 FO4 delays (synthesized for a generic library); a cycle has about 83"),
            integer_multiply.interval: Assumed("the same"),
            integer_add.latency: Assumed("a comparison of 34 bits takes 23 FO4 delays (synthesized as above); a cycle has about 83"),
            integer_add.interval: Assumed("the same"),
        ],
        /// Arrival of the commands of a trace.
        display_list: DisplayListConfig = DisplayListConfig::default(),
        /// Marking of bump targets in a recorded trace. This machine lights bump targets itself.
        bump: BumpConfig = BumpConfig::default(),
        /// Geometry processor.
        geometry: GeometryConfig = GeometryConfig { fetch_bytes_per_cycle: 8, link_bytes: 8, ..GeometryConfig::default() } => [
            fetch_bytes_per_cycle: Assumed("64 bits per cycle at 50 MHz, of the class of the MBus of the same maker's workstations"),
            link_bytes: Assumed("as wide as the bus that delivers vertices"),
        ],
        /// Scan converter.
        scan: ScanConverterConfig = ScanConverterConfig::default(),
        /// Texel value generator (310): division points.
        texel: TexelConfig = TexelConfig::default(),
        /// Dividers.
        divider: DividerConfig = DividerConfig::default(),
        /// Approximate calculator (310a).
        approximation: ApproximationConfig = ApproximationConfig::default(),
        /// MIP-map selector (320).
        mip: MipConfig = MipConfig::default(),
        /// Texture look-up table (330).
        look_up: LookUpConfig = LookUpConfig::default(),
        /// Layout of textures in the memory of (330).
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
        display: DisplayConfig = DisplayConfig::default(),
        /// FIFOs.
        fifo: FifoConfigs = FifoConfigs::default(),
        /// Memories.
        memory: MemoryConfigs = MemoryConfigs::default(),
        /// Caches.
        cache: CacheConfigs = CacheConfigs::default(),
        /// Idealized units, for bottleneck analysis.
        ideal: IdealConfig = IdealConfig::default(),
        /// Coefficients of the area of the hardware.
        area: AreaConfig = AreaConfig { gate_length: 0.6, ..AreaConfig::default() } => [
            gate_length: Assumed("1994: 0.6 um CMOS"),
        ],
    }
}

front_of!(TexelMachineConfig, |c| VertexAttributes { lit: lit(c), normal_maps: false, textures: true });
memories_of!(TexelMachineConfig);

/// Returns where vertices are lit: nowhere without illuminance, otherwise only those of polygons that are no bump targets; (340) lights
/// bump targets.
fn lit(c: &TexelMachineConfig) -> LightingStage {
    match c.illuminance.mode {
        IlluminanceMode::Off => LightingStage::Nowhere,
        IlluminanceMode::Gouraud => LightingStage::Targets,
    }
}

impl TexelMachineConfig {
    /// Returns the swap chain of the display.
    pub(super) fn swap_chain(&self) -> SwapChain<'_> {
        SwapChain { display: &self.display, pixel_bytes: self.frame_buffer.pixel_bytes, hz: self.clock.hz, shared: false }
    }
}
