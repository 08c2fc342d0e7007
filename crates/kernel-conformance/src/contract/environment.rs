//! Test environment of the unit under test.

use basrelief_kernel::{CacheConfig, MemoryConfig};
use std::fmt;

/// The environment of the unit in one run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TestEnvironment {
    /// Slots of every FIFO.
    pub depth: usize,
    /// Cycles from delivery to visibility, of every FIFO.
    pub latency: u64,
    /// Free cycles after item n of each source, repeating.
    pub source_gaps: Vec<u64>,
    /// Cycles for which token n occupies each sink, repeating.
    pub sink_occupancy: Vec<u64>,
    /// True for a slow memory with caches of one line and only the credits of the largest step. Its ports issue one request and make
    /// one look-up per cycle.
    pub slow_memory: bool,
}

impl fmt::Display for TestEnvironment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { depth, latency, source_gaps, sink_occupancy, slow_memory } = self;
        let memory = if *slow_memory { "slow" } else { "fast" };
        write!(f, "FIFOs of {depth} slots and latency {latency}, source gaps {source_gaps:?}, ")?;
        write!(f, "sink occupancy {sink_occupancy:?}, {memory} memory")
    }
}

impl TestEnvironment {
    pub(super) fn memory(&self) -> MemoryConfig {
        let slow = MemoryConfig { banks: 1, burst_cycles: 7, cl: 40, rcd: 23, rp: 17, ..MemoryConfig::default() };
        if self.slow_memory { slow } else { MemoryConfig::default() }
    }

    pub(super) fn cache(&self, line_bytes: u32) -> CacheConfig {
        let small = CacheConfig { line_bytes, sets: 4, ways: 2, ..CacheConfig::default() };
        let tiny = CacheConfig { sets: 1, ways: 1, hit_latency: 9, lookups_per_cycle: 1, ..small.clone() };
        if self.slow_memory { tiny } else { small }
    }
}
