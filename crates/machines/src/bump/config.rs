//! All parameters of the bump-mapping processor, in the order of its block diagram, and its FIFOs.

use crate::config::{ClockConfig, IdealConfig, ReferenceConfig, TextureConfig};
use crate::display::SwapChain;
use crate::fifos::fifos;
use crate::front::front_of;
use crate::memories::{complete, explain, memories, memories_of};
use basrelief_brightness::BrightnessConfig;
use basrelief_frame_buffer::{DisplayConfig, FrameBufferConfig};
use basrelief_geometry_processor::{BumpConfig, DisplayListConfig, GeometryConfig};
use basrelief_graphics_processor::{DepthConfig, GraphicsConfig};
use basrelief_kernel::{AreaConfig, CacheConfig, MemoryConfig, MemoryPart, OperatorConfig, Operators};
use basrelief_normal_mapping::NormalMappingConfig;
use basrelief_parameters::parameter_groups;
use basrelief_rasterizer::RasterizerConfig;
use basrelief_replacement::ReplacementConfig;
use basrelief_signals::{
    Control, Draw, Flow, Fragment, LightingStage, NormalIndexes, Pixel, PseudoNormals, ShadedFragment, Stamp, VertexAttributes,
};

/// Default clock \[Hz\].
const HZ: u64 = 200_000_000;

memories! {
    /// Memories.
    pub struct MemoryConfigs at HZ {
        /// Normal-map memory (116). Its port has credits for the largest step: four texels of each of eight levels for each of four
        /// fragments. That equals four steps with two levels.
        normal_map = MemoryConfig { part: MemoryPart::EdramPs2, outstanding: 128, ..MemoryConfig::default() } => [
            part: Assumed("Figure 1 draws (116) as a separate memory inside the device, which means on the chip; its maker had put 4 MB of DRAM on a chip since 2000"),
            outstanding: Assumed("the largest step: 4 texels of 8 levels for 4 fragments"),
        ],
        /// Quantization-vector memory (120): VQ tables (121) and CLUTs (122). Its ports have credits for four steps.
        quantization = MemoryConfig { part: MemoryPart::Sram, outstanding: 32, ..MemoryConfig::default() } => [
            part: Assumed("Figure 1 draws (120) as a separate memory inside the device; eight levels of tables and CLUTs are about 16 KB, which is SRAM on a chip"),
            outstanding: Assumed("four steps of four fragments with two levels"),
        ],
        /// Graphics-data memory (124), with the frame buffer (126).
        graphics = MemoryConfig { part: MemoryPart::Ddr400, channels: 4, outstanding: 32, ..MemoryConfig::default() } => [
            part: Assumed("graphics boards of 2005 had DDR at 200 MHz and more, up to GDDR3 at twice that and beyond"),
            channels: Assumed("256 bits, four times 64, as graphics boards had from 2002 on (Radeon 9700, GeForce 6800)"),
            outstanding: Assumed("more than rows, CL and burst of DDR-400 take at one request per cycle"),
        ],
    }
}

parameter_groups! {
    /// Caches of the memories.
    pub struct CacheConfigs {
        /// Normal-map texels, for the mapping unit (108).
        normal_map: CacheConfig = CacheConfig::default(),
        /// CLUT entries, for the brightness fetch unit (112).
        clut: CacheConfig = CacheConfig { sets: 16, ways: 2, ..CacheConfig::default() },
        /// Colour texels, for the graphics processor (104).
        color_texture: CacheConfig = CacheConfig::default(),
        /// Z values, for the z-test.
        depth: CacheConfig = CacheConfig { sets: 32, lookups_per_cycle: 1, ..CacheConfig::default() },
    }
}

fifos! {
    /// FIFOs of the bump-mapping processor, by name. Default depths sustain full throughput (law 2): latency of the
    /// producer + FIFO latency + 1, plus the loaded memory latency after a unit that waits for memory.
    pub struct FifoConfigs, Fifos {
        /// Host to geometry processor: triangles.
        draws: Draw = 16,
        /// Geometry processor to rasterizer: the display list.
        polygons: Control = 32,
        /// Rasterizer to z-test or distributor: fragments.
        fragments: Flow<Stamp<Fragment>> = 64,
        /// Z-test to distributor, with early z: fragments.
        tested_fragments: Flow<Stamp<Fragment>> = 64,
        /// Distributor to normal-vector mapping unit: fragments of bump targets.
        bump_fragments: Flow<Stamp<Fragment>> = 16,
        /// Distributor to graphics processor: other fragments.
        plain_fragments: Flow<Stamp<Fragment>> = 64,
        /// Mapping unit to replacement unit: pseudo-normals N'.
        pseudo_normals: Flow<PseudoNormals> = 128,
        /// Replacement unit to brightness fetch unit: indexes.
        indexes: Flow<NormalIndexes> = 32,
        /// Brightness fetch unit to graphics processor: brightness.
        shaded: Flow<Stamp<ShadedFragment>> = 64,
        /// Graphics processor to frame buffer, or to the z-test without early z: pixels.
        pixels: Flow<Stamp<Pixel>> = 128,
        /// Z-test to frame buffer, without early z: pixels.
        tested_pixels: Flow<Stamp<Pixel>> = 64,
    }
}

parameter_groups! {
    /// All parameters of the bump-mapping processor.
    pub struct BumpProcessorConfig completed(complete) explained(explain) renamed(crate::config::RENAMED) {
        /// Clock.
        clock: ClockConfig = ClockConfig { hz: HZ } => [
            hz: Assumed("2005, between the Graphics Synthesizer of the same maker (147 MHz, 2000) and its RSX (550 MHz, 2006)"),
        ],
        /// Latency and initiation interval of arithmetic operators, the same in every unit.
        operators: Operators = Operators {
            multiply: OperatorConfig::new(4, 1),
            add: OperatorConfig::new(4, 1),
            divide: OperatorConfig::new(7, 7),
            square_root: OperatorConfig::new(7, 7),
            power: OperatorConfig::new(44, 43),
            ..Operators::default()
        } => [
            multiply.latency: Assumed("FMAC of the vector units of the same maker's Emotion Engine (2000): 4 cycles"),
            multiply.interval: Assumed("FMAC of the vector units of the same maker's Emotion Engine (2000): one per cycle"),
            add.latency: Assumed("the same FMAC"),
            add.interval: Assumed("the same FMAC"),
            divide.latency: Assumed("DIV of the vector units of the same maker's Emotion Engine (2000): 7 cycles"),
            divide.interval: Assumed("the same DIV is not pipelined"),
            square_root.latency: Assumed("SQRT of the vector units of the same maker's Emotion Engine (2000): 7 cycles"),
            square_root.interval: Assumed("the same SQRT is not pipelined"),
            power.latency: Assumed("EEXP of the vector units of the same maker's Emotion Engine (2000), its elementary function unit: 44 cycles; a power is no cheaper"),
            power.interval: Assumed("the same EEXP: 43 cycles"),
            integer_multiply.latency: Assumed("a product of 16 bits takes 69 FO4 delays (synthesized for a generic library); a cycle has about 139"),
            integer_multiply.interval: Assumed("the same"),
            integer_add.latency: Assumed("a comparison of 34 bits takes 23 FO4 delays (synthesized as above); a cycle has about 139"),
            integer_add.interval: Assumed("the same"),
        ],
        /// Arrival of the commands of a trace.
        display_list: DisplayListConfig = DisplayListConfig::default(),
        /// Selection of bump targets.
        bump: BumpConfig = BumpConfig::default(),
        /// Geometry processor (102).
        geometry: GeometryConfig = GeometryConfig::default(),
        /// Rasterizer.
        rasterizer: RasterizerConfig = RasterizerConfig::default(),
        /// Z-test.
        depth: DepthConfig = DepthConfig::default(),
        /// Normal-vector mapping unit (108).
        normal_mapping: NormalMappingConfig = NormalMappingConfig::default(),
        /// Normal-vector replacement unit (110).
        replacement: ReplacementConfig = ReplacementConfig::default(),
        /// Brightness fetch unit (112).
        brightness: BrightnessConfig = BrightnessConfig::default(),
        /// Graphics processor (104).
        graphics: GraphicsConfig = GraphicsConfig::default(),
        /// Layout of normal maps in memory (116), and of colour textures in memory (124).
        texture: TextureConfig = TextureConfig::default(),
        /// Frame buffer (126).
        frame_buffer: FrameBufferConfig = FrameBufferConfig::default(),
        /// Display.
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
        area: AreaConfig = AreaConfig { gate_length: 0.09, ..AreaConfig::default() } => [
            gate_length: Assumed("2005: 90 nm, as the graphics chips of that year"),
        ],
        /// The reference image, which the machine's image is compared with.
        reference: ReferenceConfig = ReferenceConfig::default(),
    }
}

front_of!(BumpProcessorConfig, |c| VertexAttributes { lit: LightingStage::Targets, normal_maps: true, textures: true });
memories_of!(BumpProcessorConfig);

impl BumpProcessorConfig {
    /// Returns the swap chain of the display.
    pub(super) fn swap_chain(&self) -> SwapChain<'_> {
        SwapChain { display: &self.display, pixel_bytes: self.frame_buffer.pixel_bytes, hz: self.clock.hz, shared: false }
    }
}
