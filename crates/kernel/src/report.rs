//! The report of a run: accounting, occupancy, memory counts.

use crate::outcome::Outcome;
use crate::{BusActivity, CacheCounts, ChannelCounts, CycleAccount, FlipCounts, PortCounts};

/// The report of a unit. Inputs, outputs and clients are in the order of the wiring.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitReport {
    /// Name in the block diagram.
    pub name: String,
    /// Number of steps.
    pub steps: u64,
    /// Breakdown of its cycles; sums to the total.
    pub account: CycleAccount,
    /// Names of its input FIFOs.
    pub inputs: Vec<String>,
    /// Names of its output FIFOs.
    pub outputs: Vec<String>,
    /// Names of its memory clients.
    pub clients: Vec<String>,
}

/// The report of a FIFO.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FifoReport {
    /// Name.
    pub name: String,
    /// Slots.
    pub depth: usize,
    /// Number of tokens that passed.
    pub tokens: u64,
    /// `histogram[k]` = cycles with k slots in use; sums to the total (law 10).
    pub histogram: Vec<u64>,
}

impl FifoReport {
    /// Maximum number of slots in use.
    pub fn high_water(&self) -> usize {
        self.histogram.iter().rposition(|&n| n > 0).unwrap_or(0)
    }
}

/// The report of a memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MemoryReport {
    /// Name.
    pub name: String,
    /// Its ports, in order of number.
    pub ports: Vec<PortReport>,
    /// Its channels, in order of number.
    pub channels: Vec<ChannelCounts>,
    /// Activity of its buses over time.
    pub bus: BusActivity,
}

/// The report of a memory port.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PortReport {
    /// Name of its client.
    pub client: String,
    /// Its counters.
    pub counts: PortCounts,
    /// Counters of a periodic client; `None` for ports of units.
    pub periodic: Option<PeriodicCounts>,
}

/// Counters of a periodic client.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PeriodicCounts {
    /// Reads answered later than one period after their arrival.
    pub late: u64,
    /// Flips of the client.
    pub flips: FlipCounts,
}

/// The report of a cache.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CacheReport {
    /// Name.
    pub name: String,
    /// Results of its look-ups.
    pub counts: CacheCounts,
}

/// The report of a run. All engines give equal reports, byte for byte.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunReport {
    /// Outcome of the run.
    pub outcome: Outcome,
    /// Total cycles: 1 + the last cycle of any activity, and no fewer than up to the last mark.
    pub total: u64,
    /// Cycles from mark to mark (law 11). The rest of the total is the tail.
    pub marks: Vec<u64>,
    /// In the order of the wiring.
    pub units: Vec<UnitReport>,
    /// In the order of the wiring, by producer.
    pub fifos: Vec<FifoReport>,
    /// In the order in which they were added.
    pub memories: Vec<MemoryReport>,
    /// In the order in which they were added.
    pub caches: Vec<CacheReport>,
}

impl RunReport {
    /// Cycles up to the last mark; the total if no delivery passed a mark.
    pub fn marked_cycles(&self) -> u64 {
        if self.marks.is_empty() { self.total } else { self.marks.iter().sum() }
    }

    /// Returns the report of a run that could not begin.
    pub(crate) fn of_fault(fault: String) -> Self {
        let (marks, units, fifos, memories, caches) = Default::default();
        Self { outcome: Outcome::Fault(fault), total: 0, marks, units, fifos, memories, caches }
    }
}
