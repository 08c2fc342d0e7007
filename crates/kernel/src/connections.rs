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

/// The memory clients of one stage, in the order in which its unit numbers them. The type tells at compile time whether
/// there are any: stages without memory pay nothing for those that have it.
pub trait Clients {
    /// Whether there can be any.
    const HAS_MEMORY: bool;
    /// Their numbers among the machine's memories.
    fn ids(&self) -> &[usize];
    /// The machine's memories.
    fn memories(&self) -> Option<&MemorySystem>;
}

/// None.
impl Clients for () {
    const HAS_MEMORY: bool = false;
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
    const HAS_MEMORY: bool = true;
    fn ids(&self) -> &[usize] {
        self.ids
    }
    fn memories(&self) -> Option<&MemorySystem> {
        Some(self.memories)
    }
}
