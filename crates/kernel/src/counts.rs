//! Counters of memories, by port and by channel.

use crate::Cycle;

/// Classes of a [`Latencies`] histogram: enough for any answer within 2^31 cycles. Longer latencies count in the last class.
const CLASSES: usize = 32;

/// Histogram of answer latencies: `at_least[k]` answers took at least 2^k cycles and less than 2^(k+1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Latencies {
    /// Number of answers by class.
    pub at_least: [u64; CLASSES],
    /// Sum of the latencies \[cycles\].
    pub total: u64,
}

impl Latencies {
    /// Counts an answer that came `cycles` (>= 1) after its request.
    #[inline]
    pub(crate) fn count(&mut self, cycles: u64) {
        self.at_least[(cycles.max(1).ilog2() as usize).min(CLASSES - 1)] += 1;
        self.total = self.total.saturating_add(cycles);
    }

    /// Returns the least power of two that at least `percent` of the latencies stay below; 0 without answers.
    pub fn bound(&self, percent: u64) -> u64 {
        let all: u64 = self.at_least.iter().sum();
        let mut below = 0;
        let class = self.at_least.iter().position(|&answers| {
            below += answers;
            all > 0 && u128::from(below) * 100 >= u128::from(all) * u128::from(percent)
        });
        class.map_or(0, |class| 2 << class)
    }

    /// Returns the classes up to the last one that is not empty.
    pub fn used_classes(&self) -> &[u64] {
        let used = self.at_least.iter().rposition(|&n| n > 0).map_or(0, |last| last + 1);
        &self.at_least[..used]
    }
}

/// Row outcome of a burst.
///
/// The type is as wide as its neighbouring fields. Behind a one-byte field the compiler copies the seven padding bytes in two
/// overlapping pieces, and the processor waits until both reach the cache before it can read them back. That took a quarter of
/// the time of a memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub(crate) enum RowOutcome {
    /// The row was open.
    Hit,
    /// The bank was closed.
    Closed,
    /// Another row was open.
    Conflict,
}

/// Number of bursts by row outcome.
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

/// Counters of a port.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PortCounts {
    /// Read requests.
    pub reads: u64,
    /// Write requests.
    pub writes: u64,
    /// Requests that move no data: flips of a periodic client, and waits for the end of a hold.
    pub without_data: u64,
    /// Bytes requested by reads.
    pub read_bytes: u64,
    /// Bytes requested by writes.
    pub write_bytes: u64,
    /// Bursts of the port by row outcome. An unaligned request moves more bytes than it requests.
    pub rows: RowCounts,
    /// Cycles that its bursts waited in the queue of their channel, in view or not: from the cycle after the arrival, the
    /// earliest possible, to the column command.
    pub queue_wait: u64,
    /// Latencies from arrival to answer.
    pub latencies: Latencies,
}

impl PortCounts {
    /// Requests in all.
    pub fn requests(&self) -> u64 {
        self.reads + self.writes + self.without_data
    }

    #[inline]
    pub(crate) fn count_arrival(&mut self, write: bool, bytes: u32) {
        let (requests, total) =
            if write { (&mut self.writes, &mut self.write_bytes) } else { (&mut self.reads, &mut self.read_bytes) };
        *requests += 1;
        *total += u64::from(bytes);
    }

    #[inline]
    pub(crate) fn count_answer(&mut self, arrival: Cycle, answer: Cycle) {
        self.latencies.count(answer.since(arrival));
    }
}

/// Results of the look-ups of a cache. hits + misses + merged = look-ups.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "config", derive(schemars::JsonSchema))]
pub struct CacheCounts {
    /// Look-ups whose line was in the cache.
    pub hits: u64,
    /// Look-ups that requested the line from memory.
    pub misses: u64,
    /// Look-ups whose line was already being fetched.
    pub merged: u64,
}

/// Counters of a channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ChannelCounts {
    /// Bursts of the channel by row outcome.
    pub rows: RowCounts,
    /// Changes between reading and writing.
    pub turn_arounds: u64,
    /// Cycles in which its bus moved data.
    pub bus_busy: u64,
    /// Sum over all cycles of the bursts that waited for their column command. Divided by the cycles of the run it is the mean
    /// queue length.
    pub queued: u64,
    /// Refreshes within the run.
    pub refreshes: u64,
}

/// Maximum number of intervals of a run.
const INTERVALS: usize = 256;

/// Bus activity of a memory over time: cycles in which a bus moved data, summed over the channels, for at most 256 intervals of
/// equal length. The length is a power of two that doubles as the run goes on.
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

    /// Returns the cycles in which a bus moved data, by interval from cycle 0, up to the last active interval.
    pub fn busy(&self) -> &[u64] {
        let used = self.busy.iter().rposition(|&n| n > 0).map_or(0, |last| last + 1);
        &self.busy[..used]
    }

    /// Counts data that move from cycle `from` to the cycle before `to`; `from` < `to`.
    #[inline(always)]
    pub(crate) fn count_transfer(&mut self, from: Cycle, to: Cycle) {
        let [first, last] = [from.0, to.0 - 1].map(|at| at >> self.shift);
        // Usually the data move within one interval.
        match self.busy.get_mut(last as usize) {
            Some(busy) if first == last => *busy += to.0 - from.0,
            _ => self.count_long_transfer(from, to),
        }
    }

    #[inline(never)]
    fn count_long_transfer(&mut self, from: Cycle, to: Cycle) {
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
    fn bus_activity_counts_each_cycle_once_as_intervals_double() {
        let mut bus = BusActivity::default();
        bus.count_transfer(Cycle(3), Cycle(7));
        assert_eq!((bus.interval(), bus.busy()), (1, [0, 0, 0, 1, 1, 1, 1].as_slice()));
        bus.count_transfer(Cycle(254), Cycle(258));
        assert_eq!((bus.interval(), &bus.busy()[..4]), (2, [0, 1, 2, 1].as_slice()));
        assert_eq!(bus.busy()[127..], [2, 2]);
        bus.count_transfer(Cycle(1 << 20), Cycle((1 << 20) + 10));
        assert_eq!((bus.interval(), bus.busy().iter().sum::<u64>()), (8192, 18));
    }

    #[test]
    fn latencies_are_classed_by_power_of_two() {
        let mut latencies = Latencies::default();
        [1, 2, 3, 4, 1023, u64::MAX].into_iter().for_each(|n| latencies.count(n));
        assert_eq!(latencies.used_classes()[..10], [1, 2, 1, 0, 0, 0, 0, 0, 0, 1]);
        assert_eq!(latencies.used_classes()[CLASSES - 1], 1);
        assert_eq!([0, 16, 17, 50, 66, 80, 100].map(|percent| latencies.bound(percent)), [2, 2, 4, 4, 8, 1024, 1 << 32]);
        assert_eq!((Latencies::default().bound(95), latencies.total), (0, u64::MAX));
    }
}
