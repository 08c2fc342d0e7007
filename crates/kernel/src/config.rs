//! Parameters of FIFOs, memories and caches.

use crate::MemoryPart;
#[cfg(not(feature = "config"))]
use crate::plain_parameters::parameters;
#[cfg(feature = "config")]
use basrelief_parameters::parameters;

parameters! {
    /// A bounded FIFO between two units.
    pub struct FifoConfig {
        /// Slots.
        depth: u32 = 16, unit: "tokens", Assumed("deep enough for full rate behind units of a few cycles' latency; deeper where tokens wait longer"), range: 1..=65536, effect: Timing;
        /// Cycles from delivery to visibility.
        latency: u32 = 1, unit: "cycles", Assumed("one register"), range: 1..=1024, effect: Timing;
    }
}

parameters! {
    /// A memory: channels that share nothing, each with banks of open rows and one data bus (law 4). Names are JEDEC's; times
    /// are in cycles of the device's clock.
    pub struct MemoryConfig {
        /// Part, by its data sheet: fpm-80, edo-60, sdr-100, sdr-133, ddr-400, ddr2-667, gddr3-1400, xdr-3200, edram-ps2, sram
        /// or ideal. It gives the times, burst, banks and rows that are not set. custom gives none.
        part: MemoryPart = MemoryPart::Custom, unit: "", Assumed("numbers as they stand"), effect: Timing;
        /// Channels.
        channels: u32 = 1, unit: "channels", Assumed("the least there can be"), range: 1..=64, effect: Timing;
        /// Consecutive bytes in one channel. The bytes after them are in the next channel.
        channel_bytes: u32 = 256, unit: "bytes", Assumed("four bursts: data that are read together lie in one channel, and the data that are read next in another"), range: 4..=1048576, effect: Timing;
        /// Waiting bursts that a channel chooses from, oldest first. 1 serves bursts in order of arrival.
        window: u32 = 16, unit: "bursts", Assumed("a controller's queue of the usual size"), range: 1..=256, effect: Timing;
        /// Most later bursts that are served before the oldest one in the window.
        cap: u32 = 16, unit: "bursts", Assumed("as many as are in view"), range: 0..=65536, effect: Timing;
        /// CL: from a read command to its first data.
        cl: u32 = 3, unit: "cycles", Assumed("DDR-400 at 200 MHz: 15 ns"), range: 0..=1024, effect: Timing;
        /// CWL: from a write command to its first data.
        cwl: u32 = 1, unit: "cycles", Assumed("DDR: one clock (JESD79)"), range: 0..=1024, effect: Timing;
        /// tRCD: from activation to column command.
        rcd: u32 = 3, unit: "cycles", Assumed("DDR-400 at 200 MHz: 15 ns"), range: 0..=1024, effect: Timing;
        /// tRP: from precharge to activation.
        rp: u32 = 3, unit: "cycles", Assumed("DDR-400 at 200 MHz: 15 ns"), range: 0..=1024, effect: Timing;
        /// tRAS: from activation to precharge, at least.
        ras: u32 = 8, unit: "cycles", Assumed("DDR-400 at 200 MHz: 40 ns"), range: 0..=4096, effect: Timing;
        /// tRTP: from read command to precharge.
        rtp: u32 = 2, unit: "cycles", Assumed("DDR: half a burst of four"), range: 0..=1024, effect: Timing;
        /// tWR: from the end of write data to precharge.
        wr: u32 = 3, unit: "cycles", Assumed("DDR-400 at 200 MHz: 15 ns"), range: 0..=1024, effect: Timing;
        /// tWTR: from the end of write data to a read command.
        wtr: u32 = 2, unit: "cycles", Assumed("DDR-400: two clocks (JESD79)"), range: 0..=1024, effect: Timing;
        /// tRRD: from activation to activation of another bank.
        rrd: u32 = 2, unit: "cycles", Assumed("DDR-400 at 200 MHz: 10 ns"), range: 0..=1024, effect: Timing;
        /// tFAW: interval with at most four activations.
        faw: u32 = 0, unit: "cycles", Assumed("DDR has no such limit"), range: 0..=4096, effect: Timing;
        /// tREFI: from refresh to refresh; 0 is never. More than `rfc` and `rcd` together.
        refi: u32 = 1560, unit: "cycles", Assumed("7.8 us at 200 MHz (JESD79)"), range: 0..=16777216, effect: Timing;
        /// tRFC: from refresh to activation.
        rfc: u32 = 14, unit: "cycles", Assumed("DDR-400, 512 Mbit: 70 ns"), range: 0..=65536, effect: Timing;
        /// Bytes of one burst, which begins at a multiple of them.
        burst_bytes: u32 = 64, unit: "bytes", Assumed("8 transfers of 64 bits"), range: 4..=4096, effect: Timing;
        /// tCCD: cycles that one burst keeps the data bus.
        burst_cycles: u32 = 4, unit: "cycles", Assumed("16 bytes per cycle: two transfers of 64 bits"), range: 1..=1024, effect: Timing;
        /// Banks of a channel.
        banks: u32 = 4, unit: "banks", Assumed("DDR (JESD79)"), range: 1..=1024, effect: Timing;
        /// Bytes of one row of one bank.
        row_bytes: u32 = 2048, unit: "bytes", Assumed("common for synchronous DRAM"), range: 4..=1048576, effect: Timing;
        /// Commands that the command bus of a channel carries per cycle; 0 is any number.
        commands_per_cycle: u32 = 0, unit: "commands/cycle", Assumed("the command bus is no bottleneck"), range: 0..=64, effect: Timing;
        /// Requests of one step that arrive per cycle at each port without a cache; 0 is all at once.
        issue: u32 = 1, unit: "requests/cycle", Assumed("a port has one address bus"), range: 0..=64, effect: Timing;
        /// Requests in flight per port.
        outstanding: u32 = 8, unit: "requests", Assumed("enough that an idle memory is never waited for at one request every two cycles"), range: 1..=65536, effect: Timing;
    }
}

parameters! {
    /// A read cache in front of a memory port.
    pub struct CacheConfig {
        /// Bytes per line; a power of two.
        line_bytes: u32 = 64, unit: "bytes", Assumed("one 4 x 4 block of 32-bit values"), range: 4..=4096;
        /// Sets.
        sets: u32 = 64, unit: "sets", Assumed("64 sets x 4 lines x 64 bytes = 16 KiB, the largest working set Hakura and Gupta found (1997); caches of smaller data have fewer sets"), range: 1..=65536, effect: Timing;
        /// Lines per set.
        ways: u32 = 4, unit: "lines", Assumed("enough that two arrays read side by side do not evict each other"), range: 1..=64, effect: Timing;
        /// Cycles from look-up to data on a hit.
        hit_latency: u32 = 2, unit: "cycles", Assumed("tag, then data"), range: 0..=1024, effect: Timing;
        /// Look-ups per cycle. A step looks up each of its lines once, however many values it reads there.
        lookups_per_cycle: u32 = 4, unit: "look-ups/cycle", Assumed("one for each of four neighbouring values; 1 where a step reads one line"), range: 1..=64, effect: Timing;
        /// True if every look-up hits, which no hardware can do. The difference in cycles is the cost of the misses.
        always_hits: bool = false, unit: "", Assumed("caches miss"), effect: Timing;
    }
}
