//! Kinds of memory clients.

/// The memory or cache behind a memory client of the unit under test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClientKind {
    /// A port of the memory.
    Port,
    /// A cache in front of a port.
    Cache {
        /// Bytes per line; a power of two.
        line_bytes: u32,
    },
}
