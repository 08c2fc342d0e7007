//! Memories and their clients.

use super::DeferConfig;
use crate::memories::add_cached_client;
use basrelief_deferred_renderer::DepthPixel;
use basrelief_kernel::MemorySystem;

/// Numbers of the memory clients, by unit, in the order of priority: units near the end of the pipeline come first, as in the
/// bump-mapping processor.
#[derive(Clone, Debug)]
pub(super) struct ClientNumbers {
    pub(super) pixel_buffer: [usize; 2],
    /// In a shared memory with a third client, which waits for the display.
    pub(super) depth: Vec<usize>,
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
    let pixel_write = m.add_client("pixel_write", pixel_depth, of_pixels);
    let (scan_out, flip) = config.swap_chain().add_with_scan_out(&mut m, pixel_depth);
    let mut depth = vec![
        add_cached_client(&mut m, "z_read", pixel_depth, of_pixels, "depth", &config.cache.depth),
        m.add_client("z_write", pixel_depth, of_pixels),
    ];
    if config.defer.depth_pixel == DepthPixel::Shared {
        depth.push(m.add_wait_client("hold", scan_out, 1));
    }
    let clients = ClientNumbers {
        pixel_buffer: [pixel_write, flip],
        depth,
        reference_buffer: [m.add_client("cell_read", reference, of_cells), m.add_client("cell_write", reference, of_cells)],
        rasterization: [
            add_cached_client(&mut m, "texel_read", texture, of_texels, "texel", &config.cache.texel),
            m.add_client("tile_write", texture, of_texels),
            m.add_client("tile_read", texture, of_texels),
        ],
    };
    (m, clients)
}
