//! Traffic of memories and caches.

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a memory moved.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Memory {
    /// By name, in order of port number.
    pub clients: IndexMap<String, Client>,
    /// In order of number.
    pub channels: Vec<Channel>,
    /// When its buses moved data.
    pub bus: Bus,
}

/// When the buses of a memory moved data: one number per interval of equal length.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Bus {
    /// Length of an interval \[cycles\].
    pub interval: u64,
    /// Cycles in which a bus moved data, added up over all channels, by interval from cycle 0; what is left out is 0.
    pub busy: Vec<u64>,
}

/// What one channel of a memory moved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Channel {
    /// Bursts that found their row open.
    pub row_hits: u64,
    /// Bursts that found their bank closed.
    pub row_closed: u64,
    /// Bursts that found another row open.
    pub row_conflicts: u64,
    /// Changes between reading and writing.
    pub turn_arounds: u64,
    /// Refreshes.
    pub refreshes: u64,
    /// Cycles in which its bus moved data.
    pub bus_busy: u64,
    /// Sum over all cycles of the bursts that waited in its queue: divided by the cycles, the mean length of the queue.
    pub queued: u64,
}

/// What one client of a memory moved and how it was served.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Client {
    /// Read requests.
    pub reads: u64,
    /// Write requests.
    pub writes: u64,
    /// Bytes asked for by reads.
    pub read_bytes: u64,
    /// Bytes given by writes.
    pub write_bytes: u64,
    /// Bursts moved; a request that is not aligned moves more bytes than it asks for.
    pub bursts: u64,
    /// Bursts that found their row open.
    pub row_hits: u64,
    /// Bursts that found their bank closed.
    pub row_closed: u64,
    /// Bursts that found another row open.
    pub row_conflicts: u64,
    /// Cycles that its bursts waited in the queues of their channels, in view or not, beyond the one that each needs.
    pub queue_wait: u64,
    /// `latency[k]` = requests answered after 2^k cycles or more and less than twice that; what is left out is 0.
    pub latency: Vec<u64>,
}

impl Client {
    /// Bytes asked for, read and written.
    pub fn bytes(&self) -> u64 {
        self.read_bytes.saturating_add(self.write_bytes)
    }
}

/// What a cache's look-ups found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Cache {
    /// hits + misses + merged.
    pub look_ups: u64,
    /// The line was there.
    pub hits: u64,
    /// The line was requested from memory.
    pub misses: u64,
    /// The line was on its way.
    pub merged: u64,
}
