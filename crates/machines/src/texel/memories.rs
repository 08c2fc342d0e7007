//! Memories and their clients.

use super::TexelMachineConfig;
use crate::memories::add_cached_client;
use basrelief_kernel::MemorySystem;

/// Numbers of the memory clients, by unit, in the order of priority: units near the end of the pipeline come first, as in the
/// bump-mapping processor.
#[derive(Clone, Debug)]
pub(super) struct ClientNumbers {
    pub(super) buffer: [usize; 2],
    pub(super) combiner: [usize; 1],
    pub(super) depth: [usize; 2],
    pub(super) look_up: [usize; 1],
}

/// Builds the memories of (330), of the depth test and of (360), with their ports and caches.
pub(super) fn build(config: &TexelMachineConfig) -> (MemorySystem, ClientNumbers) {
    let mut m = MemorySystem::default();
    let texture = m.add_memory("texture", &config.memory.texture);
    let depth = m.add_memory("depth", &config.memory.depth);
    let pixel = m.add_memory("pixel", &config.memory.pixel);
    let (of_texture, of_pixel) = (config.memory.texture.outstanding, config.memory.pixel.outstanding);
    let of_depth = config.memory.depth.outstanding;
    let clients = ClientNumbers {
        buffer: [m.add_client("pixel_write", pixel, of_pixel), config.swap_chain().add(&mut m, pixel)],
        combiner: [m.add_client("pixel_read", pixel, of_pixel)],
        depth: [
            add_cached_client(&mut m, "z_read", depth, of_depth, "depth", &config.cache.depth),
            m.add_client("z_write", depth, of_depth),
        ],
        look_up: [add_cached_client(&mut m, "texel_read", texture, of_texture, "texture", &config.cache.texture)],
    };
    (m, clients)
}
