//! All parameters of the rate-limited renderer, in the order of its block diagram, and its FIFOs.

use crate::config::{ClockConfig, IdealConfig};
use crate::display::SwapChain;
use crate::fifos::fifos;
use crate::front::front_of;
use crate::memories::{complete, explain, memories, memories_of};
use basrelief_deferred_renderer::tokens::{
    CellFlow, ExpandedTile, MarkFlow, PassFlow, PassRound, StoreOrder, TileRequest, TileResponse,
};
use basrelief_deferred_renderer::{CellConfig, DepthPixel, EngineConfig, LightingMode, PathConfig, RendererConfig, TileConfig};
use basrelief_frame_buffer::{DisplayConfig, PixelBufferConfig};
use basrelief_geometry_processor::{BumpConfig, DisplayListConfig, GeometryConfig};
use basrelief_graphics_processor::DepthConfig;
use basrelief_kernel::{AreaConfig, CacheConfig, MemoryConfig, MemoryPart, OperatorConfig, Operators};
use basrelief_parameters::parameter_groups;
use basrelief_rasterizer::RasterizerConfig;
use basrelief_signals::{Control, Draw, Flow, Fragment, LightingStage, PictureFlow, Stamp, VertexAttributes};

/// Default clock \[Hz\].
const HZ: u64 = 100_000_000;

/// Memory of a graphics board of the time, 128 bits wide.
fn board(outstanding: u32) -> MemoryConfig {
    MemoryConfig { part: MemoryPart::Sdr100, channels: 2, cap: 8, outstanding, ..MemoryConfig::default() }
}

memories! {
    /// Memories.
    pub struct MemoryConfigs at HZ {
        /// Pixel/depth buffer (124).
        pixel_depth = board(32) => [
            part: Assumed("1998: memory of graphics boards and computers of that year (PC100)"),
            channels: Assumed("128 bits, twice 64, as RIVA TNT (1998)"),
            cap: Assumed("as many requests as the window holds"),
            outstanding: Assumed("more than rows, CL and burst take at one request per two cycles"),
        ],
        /// Reference buffer (126).
        reference = board(16) => [
            part: Assumed("as the pixel/depth buffer"),
            channels: Assumed("as the pixel/depth buffer"),
            cap: Assumed("as many requests as the window holds"),
            outstanding: Assumed("cells are read and written in order"),
        ],
        /// Texture-data memory (130). Its ports have credits for two of the largest steps: four texels of each of two layers for each of 16
        /// pixels.
        texture = board(256) => [
            part: Assumed("as the pixel/depth buffer"),
            channels: Assumed("as the pixel/depth buffer"),
            cap: Assumed("as many requests as the window holds"),
            outstanding: Assumed("the largest step, 4 texels of 2 layers for 16 pixels, twice"),
        ],
    }
}

parameter_groups! {
    /// Caches of the memories.
    pub struct CacheConfigs {
        /// Depth values, for the z-test.
        depth: CacheConfig = CacheConfig { sets: 32, lookups_per_cycle: 1, ..CacheConfig::default() },
        /// Texels, for the final rasterization.
        texel: CacheConfig = CacheConfig::default(),
    }
}

fifos! {
    /// FIFOs of the rate-limited renderer, by name. Default depths sustain full throughput (law 2): latency of the producer + FIFO
    /// latency + 1, plus the loaded memory latency after a unit that waits for memory. The FIFO
    /// of tiles on the path has a slot for each request in flight, `path.requests`.
    pub struct FifoConfigs, Fifos {
        /// Host to geometry processor: triangles.
        draws: Draw = 16,
        /// Geometry processor to server (110): the display list, in its polygon memory (112).
        polygons: Control = 32,
        /// Server (110) to path: polygons and tiles.
        parcels: TileResponse = 4,
        /// Path to rasterizer: polygons.
        mesh: Control = 16,
        /// Expander to texture-data memory (130): tiles.
        expanded: ExpandedTile = 2,
        /// Rasterizer to z-test: fragments.
        fragments: Flow<Stamp<Fragment>> = 96,
        /// Z-test to cell generator: visible fragments.
        tested_fragments: Flow<Stamp<Fragment>> = 64,
        /// Cell generator to reference buffer (126): cells.
        cells: CellFlow = 72,
        /// Reference buffer (126) to identification (461): blocks of cells.
        marking: PassFlow = 8,
        /// Reference buffer (126) to final rasterization (463, 472): blocks of cells.
        colouring: PassFlow = 8,
        /// Identification (461) to tile load lists (136): tiles to mark.
        marks: MarkFlow = 16,
        /// Final rasterization (472) to tile load lists (136): tiles that would improve the picture.
        improvements: MarkFlow = 16,
        /// Tile load lists (136) to server (110): requests.
        requests: TileRequest = 8,
        /// Tile load lists (136) to texture-data memory (130): fates of tiles.
        orders: StoreOrder = 16,
        /// Tile load lists (136) to reference buffer (126): start of another round.
        rounds: PassRound = 2,
        /// Final rasterization to pixel buffer (124): blocks of pixels.
        pixels: PictureFlow = 16,
        /// Pixel buffer (124) to server (110): the last picture of a frame is shown.
        shown: () = 2,
    }
}

parameter_groups! {
    /// All parameters of the rate-limited renderer.
    pub struct DeferConfig completed(complete) explained(explain) renamed(crate::config::RENAMED) {
        /// Clock.
        clock: ClockConfig = ClockConfig { hz: HZ } => [
            hz: Assumed("1998: clock of graphics chips of that year (RIVA TNT 90 MHz), and of PC100 memory"),
        ],
        /// Latency and initiation interval of arithmetic operators, the same in every unit.
        operators: Operators = Operators {
            multiply: OperatorConfig::new(3, 1),
            add: OperatorConfig::new(3, 1),
            divide: OperatorConfig::new(17, 17),
            square_root: OperatorConfig::new(17, 17),
            power: OperatorConfig::new(54, 54),
            ..Operators::default()
        } => [
            multiply.latency: Assumed("PA-8000 (1996), of the same maker: FMAC 3 cycles"),
            multiply.interval: Assumed("the same, pipelined"),
            add.latency: Assumed("the same FMAC"),
            add.interval: Assumed("the same, pipelined"),
            divide.latency: Assumed("the same processor: division in single precision 17 cycles"),
            divide.interval: Assumed("the same, not pipelined"),
            square_root.latency: Assumed("the same processor: root in single precision 17 cycles"),
            square_root.interval: Assumed("the same, not pipelined"),
            power.latency: Assumed("a logarithm and an exponential of about 25 cycles each, by polynomials on the same FMAC, and a product"),
            power.interval: Assumed("the same, one at a time"),
            integer_multiply.latency: Assumed("a product of 16 bits takes 69 FO4 delays (synthesized for a generic library); a cycle has about 83"),
            integer_multiply.interval: Assumed("the same"),
            integer_add.latency: Assumed("a comparison of 34 bits takes 23 FO4 delays (synthesized as above); a cycle has about 83"),
            integer_add.interval: Assumed("the same"),
        ],
        /// Arrival of the commands of a trace.
        display_list: DisplayListConfig = DisplayListConfig::default(),
        /// Marking of bump targets in a recorded trace. Only machine `bump` uses the marks.
        bump: BumpConfig = BumpConfig::default(),
        /// Geometry processing (453).
        geometry: GeometryConfig = GeometryConfig { fetch_bytes_per_cycle: 8, ..GeometryConfig::default() } => [
            fetch_bytes_per_cycle: Assumed("64 bits per cycle, the transfer rate of the server's PC100 memory"),
        ],
        /// Rendering device (100).
        defer: RendererConfig = RendererConfig::default(),
        /// Tiles.
        tile: TileConfig = TileConfig::default(),
        /// Path (104, 106, 108).
        path: PathConfig = PathConfig::default(),
        /// Rasterizer.
        rasterizer: RasterizerConfig = RasterizerConfig { dividers: 17, ..RasterizerConfig::default() } => [
            dividers: Assumed("one fragment per cycle with divisions of 17 cycles that are not pipelined, so 17 dividers take turns; graphics chips of 1998 drew two per cycle (RIVA TNT)"),
        ],
        /// Z-test, with the depth values in (124).
        depth: DepthConfig = DepthConfig::default(),
        /// Cells of the reference buffer (126).
        cell: CellConfig = CellConfig::default(),
        /// Rates of the rendering engine (120).
        engine: EngineConfig = EngineConfig::default(),
        /// Pixel buffer (124).
        frame_buffer: PixelBufferConfig = PixelBufferConfig::default(),
        /// Video output (116).
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
        area: AreaConfig = AreaConfig { gate_length: 0.3, ..AreaConfig::default() } => [
            gate_length: Assumed("1998: 0.25 to 0.35 um CMOS"),
        ],
    }
}

front_of!(DeferConfig, |c| VertexAttributes { lit: lit(c), normal_maps: false, textures: true });
memories_of!(DeferConfig);

/// Returns where vertices are lit: only if cells contain brightness.
fn lit(c: &DeferConfig) -> LightingStage {
    match c.defer.lighting {
        LightingMode::None => LightingStage::Nowhere,
        LightingMode::Gouraud => LightingStage::AtVertices,
    }
}

impl DeferConfig {
    /// Returns the swap chain of the display.
    pub(super) fn swap_chain(&self) -> SwapChain<'_> {
        SwapChain {
            display: &self.display,
            pixel_bytes: self.frame_buffer.pixel_bytes,
            hz: self.clock.hz,
            shared: self.defer.depth_pixel == DepthPixel::Shared,
        }
    }
}
