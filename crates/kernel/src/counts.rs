//! What memories count: by port, and by channel.

use crate::Cycle;

/// Classes of a [`Latencies`] histogram: enough for any answer within 2^31 cycles; longer ones count as the last.
const CLASSES: usize = 32;

/// How long answers took: `at_least[k]` of them took 2^k cycles or more, and less than twice that.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Latencies {
    /// Number of answers, by class.
    pub at_least: [u64; CLASSES],
}

impl Latencies {
    /// Counts an answer that came `cycles` (>= 1) after its request.
    #[inline]
    pub(crate) fn count(&mut self, cycles: u64) {
        self.at_least[(cycles.max(1).ilog2() as usize).min(CLASSES - 1)] += 1;
    }

    /// The classes up to the last that is not empty.
    pub fn used(&self) -> &[u64] {
        let used = self.at_least.iter().rposition(|&n| n > 0).map_or(0, |last| last + 1);
        &self.at_least[..used]
    }
}

/// How bursts found their rows.
///
/// As wide as what it stands beside: behind a byte the compiler copies seven that hold nothing in two pieces that overlap, and the
/// processor waits for both to reach the cache before it can read them back. That took a quarter of what a memory takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub(crate) enum RowOutcome {
    /// Open.
    Hit,
    /// Their bank was closed.
    Closed,
    /// Another row was open.
    Conflict,
}

/// How many bursts found their rows how.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RowCounts {
    /// Their row was open.
    pub hits: u64,
    /// Their bank was closed.
    pub closed: u64,
    /// Another row was open.
    pub conflicts: u64,
}

impl RowCounts {
    #[inline]
    pub(crate) fn count(&mut self, row: RowOutcome) {
        *match row {
            RowOutcome::Hit => &mut self.hits,
            RowOutcome::Closed => &mut self.closed,
            RowOutcome::Conflict => &mut self.conflicts,
        } += 1;
    }

    /// Bursts in all.
    pub fn bursts(&self) -> u64 {
        self.hits + self.closed + self.conflicts
    }
}

/// What a port moved and how it was served.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PortCounts {
    /// Read requests.
    pub reads: u64,
    /// Write requests.
    pub writes: u64,
    /// Bytes asked for by reads.
    pub read_bytes: u64,
    /// Bytes given by writes.
    pub write_bytes: u64,
    /// Its bursts; a request that is not aligned moves more bytes than it asks for.
    pub rows: RowCounts,
    /// Cycles that its bursts waited in the queue of their channel, in view or not: from the cycle after the arrival, which
    /// none can avoid, to the column command.
    pub queue_wait: u64,
    /// From arrival to answer.
    pub latencies: Latencies,
}

impl PortCounts {
    /// Requests in all.
    pub fn requests(&self) -> u64 {
        self.reads + self.writes
    }

    #[inline]
    pub(crate) fn arrived(&mut self, write: bool, bytes: u32) {
        let (requests, total) =
            if write { (&mut self.writes, &mut self.write_bytes) } else { (&mut self.reads, &mut self.read_bytes) };
        *requests += 1;
        *total += u64::from(bytes);
    }

    #[inline]
    pub(crate) fn answered(&mut self, arrival: Cycle, answer: Cycle) {
        self.latencies.count(answer.since(arrival));
    }
}

/// What a cache's look-ups found. hits + misses + merged = look-ups.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "config", derive(schemars::JsonSchema))]
pub struct CacheCounts {
    /// The line was there.
    pub hits: u64,
    /// The line was requested from memory.
    pub misses: u64,
    /// The line was on its way.
    pub merged: u64,
}

/// What a channel moved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ChannelCounts {
    /// Its bursts.
    pub rows: RowCounts,
    /// Changes between reading and writing.
    pub turn_arounds: u64,
    /// Cycles in which its bus moved data.
    pub bus_busy: u64,
    /// Sum over all cycles of the bursts that waited for their column command: divided by the cycles of the run, the mean
    /// length of its queue.
    pub queued: u64,
    /// Refreshes within the run.
    pub refreshes: u64,
}

/// Most intervals that a run is divided into.
const INTERVALS: usize = 256;

/// When the buses of a memory moved data: how many cycles, added up over its channels, in each of at most 256 intervals of
/// equal length. That is a power of two, doubled as the run goes on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BusActivity {
    shift: u32,
    busy: Box<[u64; INTERVALS]>,
}

impl Default for BusActivity {
    fn default() -> Self {
        Self { shift: 0, busy: Box::new([0; INTERVALS]) }
    }
}

impl BusActivity {
    /// Length of an interval \[cycles\].
    pub fn interval(&self) -> u64 {
        1 << self.shift
    }

    /// Cycles in which a bus moved data, by interval from cycle 0, up to the last in which any did.
    pub fn busy(&self) -> &[u64] {
        let used = self.busy.iter().rposition(|&n| n > 0).map_or(0, |last| last + 1);
        &self.busy[..used]
    }

    /// Counts data that move from one cycle to the one before another, later one.
    #[inline(always)]
    pub(crate) fn moved(&mut self, from: Cycle, to: Cycle) {
        let [first, last] = [from.0, to.0 - 1].map(|at| at >> self.shift);
        // Mostly they move within an interval.
        match self.busy.get_mut(last as usize) {
            Some(busy) if first == last => *busy += to.0 - from.0,
            _ => self.moved_across(from, to),
        }
    }

    #[inline(never)]
    fn moved_across(&mut self, from: Cycle, to: Cycle) {
        while (to.0 - 1) >> self.shift >= INTERVALS as u64 {
            self.double();
        }
        let mut at = from.0;
        while at < to.0 {
            let interval = at >> self.shift;
            let end = to.0.min((interval + 1) << self.shift);
            self.busy[interval as usize] += end - at;
            at = end;
        }
    }

    #[cold]
    fn double(&mut self) {
        let halves = std::array::from_fn(|i| if i < INTERVALS / 2 { self.busy[2 * i] + self.busy[2 * i + 1] } else { 0 });
        *self.busy = halves;
        self.shift += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bus_counts_every_cycle_once_in_intervals_that_double() {
        let mut bus = BusActivity::default();
        bus.moved(Cycle(3), Cycle(7));
        assert_eq!((bus.interval(), bus.busy()), (1, [0, 0, 0, 1, 1, 1, 1].as_slice()));
        bus.moved(Cycle(254), Cycle(258));
        assert_eq!((bus.interval(), &bus.busy()[..4]), (2, [0, 1, 2, 1].as_slice()));
        assert_eq!(bus.busy()[127..], [2, 2]);
        bus.moved(Cycle(1 << 20), Cycle((1 << 20) + 10));
        assert_eq!((bus.interval(), bus.busy().iter().sum::<u64>()), (8192, 18));
    }

    #[test]
    fn latencies_are_classed_by_their_power_of_two() {
        let mut latencies = Latencies::default();
        [1, 2, 3, 4, 1023, u64::MAX].into_iter().for_each(|n| latencies.count(n));
        assert_eq!(latencies.used()[..10], [1, 2, 1, 0, 0, 0, 0, 0, 0, 1]);
        assert_eq!(latencies.used()[CLASSES - 1], 1);
    }
}
