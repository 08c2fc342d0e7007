//! Connections of a stage: FIFOs on its two sides, and the memories that it uses.

use crate::MemorySystem;
use crate::cache::CacheTagArray;
use crate::step_requests::TagLookup;

/// Connections of a stage.
#[derive(Debug)]
pub struct Connections<I, O, C> {
    /// The FIFOs that it pops from, in order.
    pub inputs: I,
    /// The FIFOs that it pushes to, in order.
    pub outputs: O,
    /// Its memory clients.
    pub clients: C,
}

/// The memory clients of one stage, in the order in which its unit numbers them. The type states at compile time if there can be
/// any, so stages without memory pay nothing for those with memory.
pub trait Clients {
    /// True if there can be any client.
    const HAS_MEMORY: bool;
    /// Their numbers among the machine's memories.
    fn ids(&self) -> &[usize];
    /// The machine's memories.
    fn memories(&self) -> Option<&MemorySystem>;
}

/// A stage without memory clients.
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

impl TagLookup for MemoryClients<'_> {
    #[inline(always)]
    fn clients(&self) -> usize {
        self.ids.len()
    }
    #[inline(always)]
    fn tags(&mut self, client: usize) -> Option<(&mut CacheTagArray, u64)> {
        self.memories.tags(self.ids[client])
    }
}
