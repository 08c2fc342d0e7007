//! What memories count: by port, and by channel.

use crate::Cycle;
use serde::{Deserialize, Serialize};

/// Classes of a [`Latencies`] histogram: enough for any answer within 2^31 cycles; longer ones count as the last.
const CLASSES: usize = 32;

/// How long answers took: `at_least[k]` of them took 2^k cycles or more, and less than twice that.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Row {
    /// Open.
    Hit,
    /// Their bank was closed.
    Closed,
    /// Another row was open.
    Conflict,
}

/// How many bursts found their rows how.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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
    pub(crate) fn count(&mut self, row: Row) {
        *match row {
            Row::Hit => &mut self.hits,
            Row::Closed => &mut self.closed,
            Row::Conflict => &mut self.conflicts,
        } += 1;
    }

    /// Bursts in all.
    pub fn bursts(&self) -> u64 {
        self.hits + self.closed + self.conflicts
    }
}

/// What a port moved and how it was served.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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

/// What a channel moved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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
