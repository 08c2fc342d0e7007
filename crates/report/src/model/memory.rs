//! Traffic of memories and caches.

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Bytes of a memory, or of all memories.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct MemoryBytes {
    /// Bytes that clients requested.
    pub requested: u64,
    /// Bytes of whole bursts that the buses transferred.
    pub moved: u64,
}

impl MemoryBytes {
    /// Returns the sums of some bytes. They saturate, because a report may come from a file.
    pub(crate) fn sum(all: impl Iterator<Item = Self>) -> Self {
        all.fold(Self::default(), |sum, bytes| Self {
            requested: sum.requested.saturating_add(bytes.requested),
            moved: sum.moved.saturating_add(bytes.moved),
        })
    }
}

/// Traffic of a memory.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Memory {
    /// Clients, in order of port number.
    pub clients: IndexMap<String, Client>,
    /// Channels, in order of number.
    pub channels: Vec<Channel>,
    /// Utilization of the data buses over time.
    pub bus: Bus,
    /// Bytes of all clients. Absent in older reports.
    #[serde(default)]
    pub bytes: MemoryBytes,
}

impl Memory {
    /// Sets the bytes that follow from the clients' bursts of `burst_bytes` each. If the size is unknown, moved bytes are requested
    /// bytes.
    pub(crate) fn count_bytes(&mut self, burst_bytes: Option<u64>) {
        for client in self.clients.values_mut() {
            client.moved_bytes = burst_bytes.map_or_else(|| client.requested(), |bytes| client.bursts.saturating_mul(bytes));
        }
        let of_client = |client: &Client| MemoryBytes { requested: client.requested(), moved: client.moved_bytes };
        self.bytes = MemoryBytes::sum(self.clients.values().map(of_client));
    }
}

/// Utilization of the data buses of a memory over time, in intervals of equal length.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Bus {
    /// Length of an interval \[cycles\].
    pub interval: u64,
    /// Busy bus cycles of all channels in each interval, from cycle 0. Missing intervals are 0.
    pub busy: Vec<u64>,
}

/// Traffic of one channel of a memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Channel {
    /// Bursts to an open row.
    pub row_hits: u64,
    /// Bursts to a closed bank.
    pub row_closed: u64,
    /// Bursts to a bank with another row open.
    pub row_conflicts: u64,
    /// Changes between reads and writes.
    #[serde(rename = "turnarounds", alias = "turn_arounds")]
    pub turn_arounds: u64,
    /// Refreshes.
    pub refreshes: u64,
    /// Busy cycles of the data bus.
    pub bus_busy: u64,
    /// Sum over all cycles of the bursts in the queue. Divided by the cycles, it is the mean queue length. At a cycle limit it includes
    /// what follows until the last requests are served.
    pub queued: u64,
}

/// Traffic and latency of one client of a memory.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Client {
    /// Read requests.
    pub reads: u64,
    /// Write requests.
    pub writes: u64,
    /// Bytes requested by reads.
    pub read_bytes: u64,
    /// Bytes written.
    pub write_bytes: u64,
    /// Bursts. A request that is not aligned moves more bytes than it requests.
    pub bursts: u64,
    /// Bytes of its bursts. Absent in older reports.
    #[serde(default)]
    pub moved_bytes: u64,
    /// Bursts to an open row.
    pub row_hits: u64,
    /// Bursts to a closed bank.
    pub row_closed: u64,
    /// Bursts to a bank with another row open.
    pub row_conflicts: u64,
    /// Cycles that its bursts waited in the queues of their channels, beyond the one cycle that each needs.
    pub queue_wait: u64,
    /// Sum of the latencies from arrival to answer \[cycles\]. Divided by the requests, it is the mean latency.
    #[serde(default)]
    pub latency_sum: u64,
    /// Least power of two \[cycles\] that 95 % of the latencies stay below. 0 without requests.
    #[serde(default)]
    pub latency_95: u64,
    /// `latency[k]` = requests with a latency of at least 2^k and less than 2^(k+1) cycles. Missing entries are 0.
    pub latency: Vec<u64>,
}

impl Client {
    /// Returns the mean latency \[cycles\], if there are requests.
    pub fn mean_latency(&self) -> Option<f64> {
        let answers: u64 = self.latency.iter().sum();
        (answers > 0).then(|| self.latency_sum as f64 / answers as f64)
    }

    /// True if its requests move no data: flips of a display, and waits until the display has read a picture.
    pub fn waits_for_display(&self) -> bool {
        self.reads == 0 && self.writes == 0 && self.latency_sum > 0
    }

    /// Returns the bytes that it requested.
    pub fn requested(&self) -> u64 {
        self.read_bytes.saturating_add(self.write_bytes)
    }
}

/// Hits and misses of a cache.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Cache {
    /// Lookups: hits + misses + merged.
    #[serde(rename = "lookups", alias = "look_ups")]
    pub look_ups: u64,
    /// Lookups that found their line.
    pub hits: u64,
    /// Lookups that requested their line from memory.
    pub misses: u64,
    /// Lookups of a line that was already requested.
    pub merged: u64,
}
