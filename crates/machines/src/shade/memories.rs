//! The frame memory (300) and its clients.

use super::ShadeConfig;
use basrelief_kernel::MemorySystem;

/// Numbers of the memory clients, by unit. What drains the machine comes first, as in the bump-mapping processor.
#[derive(Clone, Debug)]
pub(super) struct ClientNumbers {
    pub(super) frame_memory: [usize; 1],
    pub(super) depth: [usize; 2],
    pub(super) video_out: [usize; 1],
}

/// Builds the frame memory (300) with its ports and its cache.
pub(super) fn build(config: &ShadeConfig) -> (MemorySystem, ClientNumbers) {
    let mut m = MemorySystem::default();
    let frame = m.add_memory("frame", &config.memory.frame);
    let outstanding = config.memory.frame.outstanding;
    let clients = ClientNumbers {
        frame_memory: [m.add_client("pixel_write", frame, outstanding)],
        depth: [
            m.add_cached_client("z_read", frame, outstanding, "depth", &config.cache.depth),
            m.add_client("z_write", frame, outstanding),
        ],
        video_out: [m.add_client("video_out", frame, outstanding)],
    };
    (m, clients)
}
