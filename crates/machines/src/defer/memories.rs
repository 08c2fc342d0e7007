//! Memories and their clients.

use super::DeferConfig;
use crate::memories::add_cached_client;
use basrelief_kernel::MemorySystem;

/// Numbers of the memory clients, by unit, in the order of priority: units near the end of the pipeline come first, as in the
/// bump-mapping processor.
#[derive(Clone, Debug)]
pub(super) struct ClientNumbers {
    pub(super) pixel_buffer: [usize; 2],
    pub(super) depth: [usize; 2],
    pub(super) reference_buffer: [usize; 2],
    pub(super) rasterization: [usize; 3],
}

/// Builds the memories with their ports and caches.
pub(super) fn build(config: &DeferConfig) -> (MemorySystem, ClientNumbers) {
    let mut m = MemorySystem::default();
    let memory = &config.memory;
    let pixel_depth = m.add_memory("pixel_depth", &memory.pixel_depth);
    let reference = m.add_memory("reference", &memory.reference);
    let texture = m.add_memory("texture", &memory.texture);
    let of_pixels = memory.pixel_depth.outstanding;
    let of_cells = memory.reference.outstanding;
    let of_texels = memory.texture.outstanding;
    let clients = ClientNumbers {
        pixel_buffer: [m.add_client("pixel_write", pixel_depth, of_pixels), config.swap_chain().add(&mut m, pixel_depth)],
        depth: [
            add_cached_client(&mut m, "z_read", (pixel_depth, of_pixels), ("depth", &config.cache.depth)),
            m.add_client("z_write", pixel_depth, of_pixels),
        ],
        reference_buffer: [m.add_client("cell_read", reference, of_cells), m.add_client("cell_write", reference, of_cells)],
        rasterization: [
            add_cached_client(&mut m, "texel_read", (texture, of_texels), ("texel", &config.cache.texel)),
            m.add_client("tile_write", texture, of_texels),
            m.add_client("tile_read", texture, of_texels),
        ],
    };
    (m, clients)
}
