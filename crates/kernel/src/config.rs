//! Parameters of FIFOs, memories and caches.

use basrelief_parameters::parameters;

parameters! {
    /// A bounded FIFO between two units.
    pub struct FifoConfig {
        /// Slots.
        depth: u32 = 16, unit: "tokens", Assumed("deep enough for full rate behind units of a few cycles' latency"), range: 1..=65536;
        /// Cycles from delivery to visibility.
        latency: u32 = 1, unit: "cycles", Assumed("one register"), range: 1..=1024;
    }
}

parameters! {
    /// A memory with banks of open rows and one data bus.
    pub struct MemoryConfig {
        /// Bytes of one burst, which begins at a multiple of them.
        burst_bytes: u32 = 64, unit: "bytes", Assumed("16 transfers of 32 bits"), range: 4..=4096;
        /// Cycles the data bus is kept by one burst.
        burst_cycles: u32 = 4, unit: "cycles", Assumed("16 bytes per cycle"), range: 1..=1024;
        /// Banks.
        banks: u32 = 8, unit: "banks", Assumed("common for synchronous DRAM"), range: 1..=1024;
        /// Bytes of one row of one bank.
        row_bytes: u32 = 2048, unit: "bytes", Assumed("common for synchronous DRAM"), range: 4..=1048576;
        /// Column access: cycles from command to first data on an open row.
        cas: u32 = 6, unit: "cycles", Assumed("common for synchronous DRAM"), range: 0..=1024;
        /// Row to column: extra cycles when the bank is closed.
        rcd: u32 = 6, unit: "cycles", Assumed("common for synchronous DRAM"), range: 0..=1024;
        /// Precharge: extra cycles when another row is open.
        rp: u32 = 6, unit: "cycles", Assumed("common for synchronous DRAM"), range: 0..=1024;
        /// Requests in flight per port.
        outstanding: u32 = 8, unit: "requests", Assumed("enough that an idle memory is never waited for at one request every two cycles"), range: 1..=65536;
    }
}

parameters! {
    /// A read cache in front of a memory port.
    pub struct CacheConfig {
        /// Bytes per line; a power of two.
        line_bytes: u32 = 64, unit: "bytes", Assumed("one 4 x 4 block of 32-bit values"), range: 4..=4096;
        /// Sets.
        sets: u32 = 64, unit: "sets", Assumed("64 sets x 4 lines x 64 bytes = 16 KiB, the largest working set Hakura and Gupta found (1997); small tables need fewer"), range: 1..=65536;
        /// Lines per set.
        ways: u32 = 4, unit: "lines", Assumed("enough that two arrays read side by side do not evict each other"), range: 1..=64;
        /// Cycles from look-up to data on a hit.
        hit_latency: u32 = 2, unit: "cycles", Assumed("tag, then data"), range: 0..=1024;
        /// Look-ups per cycle.
        lookups_per_cycle: u32 = 4, unit: "look-ups/cycle", Assumed("one for each of four neighbouring values"), range: 1..=64;
    }
}
