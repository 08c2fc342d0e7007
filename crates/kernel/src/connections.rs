//! What a stage is connected to: FIFOs on its two sides, and the memories that it uses.

use crate::MemorySystem;

/// What a stage is connected to.
#[derive(Debug)]
pub struct Connections<I, O, C> {
    /// The FIFOs that it pops from, in order.
    pub inputs: I,
    /// The FIFOs that it pushes to, in order.
    pub outputs: O,
    /// Its memory clients.
    pub clients: C,
}

/// The memory clients of one stage, in the order in which its unit numbers them.
pub trait Clients {
    /// Their numbers among the machine's memories.
    fn ids(&self) -> &[usize];
    /// The machine's memories.
    fn memories(&self) -> Option<&MemorySystem>;
}

/// None.
impl Clients for () {
    fn ids(&self) -> &[usize] {
        &[]
    }
    fn memories(&self) -> Option<&MemorySystem> {
        None
    }
}

/// Clients of the machine's memories, by number.
#[derive(Debug)]
pub struct MemoryClients<'m> {
    pub(crate) memories: &'m mut MemorySystem,
    pub(crate) ids: &'m [usize],
}

impl Clients for MemoryClients<'_> {
    fn ids(&self) -> &[usize] {
        self.ids
    }
    fn memories(&self) -> Option<&MemorySystem> {
        Some(self.memories)
    }
}
