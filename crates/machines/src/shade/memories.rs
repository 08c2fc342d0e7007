//! Frame memory (300) and memory (12) of the microcomputer, with their clients.

use super::ShadeConfig;
use crate::memories::add_cached_client;
use basrelief_kernel::MemorySystem;

/// Numbers of the memory clients, by unit, in the order of priority: units near the end of the pipeline come first, as in the
/// bump-mapping processor.
#[derive(Clone, Debug)]
pub(super) struct ClientNumbers {
    pub(super) frame_memory: [usize; 2],
    pub(super) depth: [usize; 2],
    pub(super) host: [usize; 1],
    pub(super) microcomputer: [usize; 1],
}

/// Builds the memories with their ports and the cache.
pub(super) fn build(config: &ShadeConfig) -> (MemorySystem, ClientNumbers) {
    let mut m = MemorySystem::default();
    let frame = m.add_memory("frame", &config.memory.frame);
    let local = m.add_memory("local", &config.memory.local);
    let outstanding = config.memory.frame.outstanding;
    let of_local = config.memory.local.outstanding;
    let clients = ClientNumbers {
        frame_memory: [m.add_client("pixel_write", frame, outstanding), config.swap_chain().add(&mut m, frame)],
        depth: [
            add_cached_client(&mut m, "z_read", frame, outstanding, "depth", &config.cache.depth),
            m.add_client("z_write", frame, outstanding),
        ],
        host: [m.add_client("host_write", local, of_local)],
        microcomputer: [m.add_client("cpu", local, of_local)],
    };
    (m, clients)
}
