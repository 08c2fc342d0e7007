//! What a run came to: accounting, occupancy, traffic.

use crate::outcome::Outcome;
use crate::{Account, BusActivity, CacheCounts, ChannelCounts, PortCounts};

/// A unit's part of the report. Inputs, outputs and clients stand in the order of the wiring.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitReport {
    /// Name in the block diagram.
    pub name: String,
    /// Steps made.
    pub steps: u64,
    /// Where its cycles went; sums to the total.
    pub account: Account,
    /// Names of its input FIFOs.
    pub inputs: Vec<String>,
    /// Names of its output FIFOs.
    pub outputs: Vec<String>,
    /// Names of its memory clients.
    pub clients: Vec<String>,
}

/// A FIFO's part of the report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FifoReport {
    /// Name.
    pub name: String,
    /// Slots.
    pub depth: usize,
    /// Tokens that went through.
    pub tokens: u64,
    /// `histogram[k]` = cycles with k slots held; sums to the total (law 10).
    pub histogram: Vec<u64>,
}

impl FifoReport {
    /// Most slots ever held.
    pub fn high_water(&self) -> usize {
        self.histogram.iter().rposition(|&n| n > 0).unwrap_or(0)
    }
}

/// A memory's part of the report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MemoryReport {
    /// Name.
    pub name: String,
    /// Its ports, in order of number.
    pub ports: Vec<PortReport>,
    /// Its channels, in order of number.
    pub channels: Vec<ChannelCounts>,
    /// When its buses moved data.
    pub bus: BusActivity,
}

/// A memory port's part of the report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PortReport {
    /// The client behind it.
    pub client: String,
    /// What it moved.
    pub counts: PortCounts,
}

/// A cache's part of the report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CacheReport {
    /// Name.
    pub name: String,
    /// What its look-ups found.
    pub counts: CacheCounts,
}

/// What a run came to. Equal, byte for byte, whatever the engine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunReport {
    /// How it ended.
    pub outcome: Outcome,
    /// Cycles in all: 1 + the last cycle in which anything moved.
    pub total: u64,
    /// Cycles up to each mark from the one before (law 11); what is left of the total is drain.
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
    /// Cycles up to the last mark; all, where no delivery passed one.
    pub fn marked_cycles(&self) -> u64 {
        if self.marks.is_empty() { self.total } else { self.marks.iter().sum() }
    }

    /// Of a run that could not begin.
    pub(crate) fn of_fault(fault: String) -> Self {
        let (marks, units, fifos, memories, caches) = Default::default();
        Self { outcome: Outcome::Fault(fault), total: 0, marks, units, fifos, memories, caches }
    }
}
