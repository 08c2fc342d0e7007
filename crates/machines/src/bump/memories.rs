//! Memories and their clients.

use super::BumpProcessorConfig;
use crate::memories::add_cached_client;
use basrelief_kernel::MemorySystem;

/// Numbers of the memory clients, by unit, in the unit's own order.
///
/// Ports are numbered from the end of the pipeline, so that units that drain the machine win over units that fill it when both requests
/// arrive in one cycle. This order is assumed.
#[derive(Clone, Debug)]
pub(super) struct ClientNumbers {
    pub(super) mapping: [usize; 1],
    pub(super) replacement: [usize; 2],
    pub(super) brightness: [usize; 2],
    pub(super) graphics: [usize; 2],
    pub(super) depth: [usize; 2],
    pub(super) frame_buffer: [usize; 2],
}

/// Builds the memories (116), (120) and (124) with their ports and caches.
pub(super) fn build(config: &BumpProcessorConfig) -> (MemorySystem, ClientNumbers) {
    let (memory, cache) = (&config.memory, &config.cache);
    let mut m = MemorySystem::default();
    let normal_map = m.add_memory("normal_map", &memory.normal_map);
    let quantization = m.add_memory("quantization", &memory.quantization);
    let graphics = m.add_memory("graphics", &memory.graphics);
    let on_normal_map = memory.normal_map.outstanding;
    let on_quantization = memory.quantization.outstanding;
    let on_graphics = memory.graphics.outstanding;
    let clients = ClientNumbers {
        mapping: [add_cached_client(&mut m, "texels", normal_map, on_normal_map, "normal_map", &cache.normal_map)],
        brightness: [
            add_cached_client(&mut m, "clut_read", quantization, on_quantization, "clut", &cache.clut),
            m.add_client("clut_build", quantization, on_quantization),
        ],
        replacement: [
            m.add_client("tables", quantization, on_quantization),
            m.add_client("gathered", quantization, on_quantization),
        ],
        frame_buffer: [m.add_client("pixel_write", graphics, on_graphics), config.swap_chain().add(&mut m, graphics)],
        graphics: [
            add_cached_client(&mut m, "color_texels", graphics, on_graphics, "color_texture", &cache.color_texture),
            m.add_client("held", graphics, on_graphics),
        ],
        depth: [
            add_cached_client(&mut m, "z_read", graphics, on_graphics, "depth", &cache.depth),
            m.add_client("z_write", graphics, on_graphics),
        ],
    };
    (m, clients)
}
