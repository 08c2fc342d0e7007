//! All parameters of the rate-limited renderer, in the order of its block diagram.

use super::fifos::FifoConfigs;
use crate::config::ClockConfig;
use crate::front::front_of;
use basrelief_deferred_renderer::{CellConfig, EngineConfig, PathConfig, RendererConfig, TileConfig};
use basrelief_frame_buffer::{PixelBufferConfig, VideoOutConfig};
use basrelief_geometry_processor::{BumpConfig, DisplayListConfig, GeometryConfig};
use basrelief_graphics_processor::DepthConfig;
use basrelief_kernel::{CacheConfig, MemoryConfig};
use basrelief_parameters::parameter_groups;
use basrelief_rasterizer::RasterizerConfig;

parameter_groups! {
    /// The three memories.
    pub struct MemoryConfigs {
        /// Pixel/depth buffer (124).
        pixel_depth: MemoryConfig = MemoryConfig { outstanding: 32, ..MemoryConfig::default() },
        /// Reference buffer (126).
        reference: MemoryConfig = MemoryConfig { outstanding: 16, ..MemoryConfig::default() },
        /// Texture-data memory (130). Its ports have the credits of the largest step, four texels of each of two layers for
        /// each of 16 pixels, twice.
        texture: MemoryConfig = MemoryConfig { outstanding: 256, ..MemoryConfig::default() },
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
    pub struct DeferConfig {
        /// Clock.
        clock: ClockConfig = ClockConfig::default(),
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
        frame_buffer: PixelBufferConfig = PixelBufferConfig::default(),
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
