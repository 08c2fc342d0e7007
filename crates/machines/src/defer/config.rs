//! All parameters of the rate-limited renderer, in the order of its block diagram.

use super::fifos::FifoConfigs;
use crate::config::ClockConfig;
use crate::front::front_of;
use crate::memories::{complete, explain, memories, memories_of};
use basrelief_deferred_renderer::{CellConfig, EngineConfig, PathConfig, RendererConfig, TileConfig};
use basrelief_frame_buffer::{FrameBufferConfig, VideoOutConfig};
use basrelief_geometry_processor::{BumpConfig, DisplayListConfig, GeometryConfig};
use basrelief_graphics_processor::DepthConfig;
use basrelief_kernel::{CacheConfig, MemoryConfig, Part};
use basrelief_parameters::parameter_groups;
use basrelief_rasterizer::RasterizerConfig;

/// Cycles per second, by default.
const HZ: u64 = 100_000_000;

/// A board of the time: 128 bits.
fn board(outstanding: u32) -> MemoryConfig {
    MemoryConfig { part: Part::Sdr100, channels: 2, window: 8, cap: 8, outstanding, ..MemoryConfig::default() }
}

memories! {
    /// The three memories.
    pub struct MemoryConfigs at HZ {
        /// Pixel/depth buffer (124).
        pixel_depth = board(32) => [
            part: Assumed("1998: what graphics boards and computers of that year had (PC100)"),
            channels: Assumed("128 bits, twice 64, as RIVA TNT (1998)"),
            window: Assumed("two bursts for each of the four banks that SDRAM brought: one moves, one opens its row"),
            cap: Assumed("as many as are in view"),
            outstanding: Assumed("more than rows, CL and burst take at one request per two cycles"),
        ],
        /// Reference buffer (126).
        reference = board(16) => [
            part: Assumed("as the pixel/depth buffer"),
            channels: Assumed("as the pixel/depth buffer"),
            window: Assumed("two bursts for each of the four banks that SDRAM brought: one moves, one opens its row"),
            cap: Assumed("as many as are in view"),
            outstanding: Assumed("cells are read and written in order"),
        ],
        /// Texture-data memory (130). Its ports have the credits of the largest step, four texels of each of two layers for
        /// each of 16 pixels, twice.
        texture = board(256) => [
            part: Assumed("as the pixel/depth buffer"),
            channels: Assumed("as the pixel/depth buffer"),
            window: Assumed("two bursts for each of the four banks that SDRAM brought: one moves, one opens its row"),
            cap: Assumed("as many as are in view"),
            outstanding: Assumed("the largest step, 4 texels of 2 layers for 16 pixels, twice"),
        ],
    }
}

parameter_groups! {
    /// The caches in front of the memories.
    pub struct CacheConfigs {
        /// Depth values, for the z-test.
        depth: CacheConfig = CacheConfig { sets: 32, lookups_per_cycle: 1, ..CacheConfig::default() },
        /// Texels, for the final rasterization.
        texel: CacheConfig = CacheConfig::default(),
    }
}

parameter_groups! {
    /// All parameters of the rate-limited renderer.
    pub struct DeferConfig completed(complete) explained(explain) {
        /// Clock.
        clock: ClockConfig = ClockConfig { hz: HZ } => [
            hz: Assumed("1998: what graphics chips of that year ran at (RIVA TNT 90 MHz), and the clock of PC100"),
        ],
        /// How a display list is fed.
        display_list: DisplayListConfig = DisplayListConfig::default(),
        /// Which polygons a display list marks as bump targets, for the machine that knows them; this one does not ask.
        bump: BumpConfig = BumpConfig::default(),
        /// Geometry processing (453).
        geometry: GeometryConfig = GeometryConfig::default(),
        /// The rendering device (100).
        defer: RendererConfig = RendererConfig::default(),
        /// Tiles.
        tile: TileConfig = TileConfig::default(),
        /// The path (104, 106, 108).
        path: PathConfig = PathConfig::default(),
        /// Rasterizer.
        rasterizer: RasterizerConfig = RasterizerConfig::default(),
        /// Z-test, with (124) as depth buffer.
        depth: DepthConfig = DepthConfig::default(),
        /// Cell of the reference buffer (126).
        cell: CellConfig = CellConfig::default(),
        /// Rates of the rendering engine (120).
        engine: EngineConfig = EngineConfig::default(),
        /// (124) as pixel buffer.
        frame_buffer: FrameBufferConfig = FrameBufferConfig::default(),
        /// Video output (116).
        video_out: VideoOutConfig = VideoOutConfig::default(),
        /// FIFOs.
        fifo: FifoConfigs = FifoConfigs::default(),
        /// Memories.
        memory: MemoryConfigs = MemoryConfigs::default(),
        /// Caches.
        cache: CacheConfigs = CacheConfigs::default(),
    }
}

front_of!(DeferConfig);
memories_of!(DeferConfig);
