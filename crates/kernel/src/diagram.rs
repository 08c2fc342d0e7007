//! The block diagram as data.

use crate::UnitInfo;

/// A stage and its wires, by name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StageTopology {
    /// Name of the stage.
    pub name: String,
    /// Purpose of its unit.
    pub role: UnitInfo,
    /// Names of its input FIFOs.
    pub inputs: Vec<String>,
    /// Names of its output FIFOs.
    pub outputs: Vec<String>,
    /// Names of its memory clients.
    pub clients: Vec<String>,
}

/// The stages, FIFOs, memories and clients of a machine, by the numbers that a probe receives.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Diagram {
    /// In the order of the wiring.
    pub stages: Vec<StageTopology>,
    /// In the order of the wiring, by producer.
    pub fifos: Vec<FifoTopology>,
    /// In the order in which they were added.
    pub memories: Vec<MemoryTopology>,
    /// In the order in which they were added.
    pub clients: Vec<ClientTopology>,
}

/// A FIFO.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FifoTopology {
    /// Its name.
    pub name: String,
    /// Slots.
    pub depth: usize,
    /// Numbers of the producer and consumer stages.
    pub ends: [usize; 2],
}

/// A memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MemoryTopology {
    /// Its name.
    pub name: String,
    /// Its channels.
    pub channels: usize,
    /// Banks of each.
    pub banks: usize,
    /// Bytes of a burst.
    pub burst_bytes: u32,
    /// Cycles for which a burst occupies the bus of its channel.
    pub burst_cycles: u64,
}

/// A memory client.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClientTopology {
    /// Its name.
    pub name: String,
    /// Number of its memory.
    pub memory: usize,
    /// Numbers of the stages that use it.
    pub stages: Vec<usize>,
    /// Maximum number of requests in flight.
    pub credits: u64,
    /// Its cache, if it has one.
    pub cache: Option<String>,
}
