//! All parameters of the texture mapping system, in the order of its block diagram.

use super::fifos::FifoConfigs;
use crate::config::ClockConfig;
use crate::front::front_of;
use basrelief_frame_buffer::{FrameBufferConfig, VideoOutConfig};
use basrelief_geometry_processor::{BumpConfig, DisplayListConfig, GeometryConfig};
use basrelief_graphics_processor::DepthConfig;
use basrelief_kernel::{CacheConfig, MemoryConfig};
use basrelief_parameters::{parameter_groups, parameters};
use basrelief_texel_value_generator::{
    ApproximationConfig, CombinerConfig, DividerConfig, IlluminanceConfig, LookUpConfig, MipConfig, ScanConverterConfig,
    TexelConfig,
};

parameters! {
    /// Pixel value buffer (360).
    pub struct PixelValueBufferConfig {
        /// Pixels are tested for depth; off: the last one drawn stays.
        depth_test: bool = true, unit: "", Assumed("the patent has none; polygons would have to come sorted");
    }
}

parameter_groups! {
    /// The three memories.
    pub struct MemoryConfigs {
        /// Memory of the texture look-up table (330). Its port has the credits of the largest step: four texels of each of two
        /// levels for each of 16 pixels.
        texture: MemoryConfig = MemoryConfig { outstanding: 128, ..MemoryConfig::default() },
        /// Depth values. The patent has none, so they have a memory of their own: in that of (360) they would keep it from its
        /// rows.
        depth: MemoryConfig = MemoryConfig { outstanding: 16, ..MemoryConfig::default() },
        /// Pixel value buffer (360).
        pixel: MemoryConfig = MemoryConfig { outstanding: 16, ..MemoryConfig::default() },
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

parameter_groups! {
    /// All parameters of the texture mapping system.
    pub struct TexelMachineConfig {
        /// Clock.
        clock: ClockConfig = ClockConfig { hz: 50_000_000 },
        /// How a display list is fed.
        display_list: DisplayListConfig = DisplayListConfig::default(),
        /// Which polygons a display list marks as bump targets, for the machine that knows them; this one lights them itself.
        bump: BumpConfig = BumpConfig::default(),
        /// Geometry processor.
        geometry: GeometryConfig = GeometryConfig::default(),
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
    }
}

front_of!(TexelMachineConfig);
