//! Service of reads of one row that arrive together.

use super::{Channel, QueuedBurst};
use crate::Cycle;
use crate::burst::Burst;
use crate::counts::RowOutcome;

/// Served reads of one row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ServedRun {
    /// Row outcome of the first burst. The others hit.
    pub(crate) row: RowOutcome,
    /// First cycle of the data, and the cycle after the last. They move without a gap.
    pub(crate) data: (Cycle, Cycle),
    /// Cycles from the arrival to the column command, summed over the bursts.
    pub(crate) queued: u64,
}

impl Channel {
    /// Serves `count` (>= 1) reads of the row of `burst`, which arrive together, as [`Channel::push`] and [`Channel::serve`] would do.
    /// Returns `None`, and does nothing, if other bursts wait, if a refresh comes between, or if the last column command is not before
    /// `until`.
    ///
    /// The bursts have equal row states, so the oldest is always first. Each later one comes into view by the column command before its
    /// own.
    pub(crate) fn serve_run(&mut self, burst: &Burst, count: u64, until: Cycle) -> Option<ServedRun> {
        if self.first < self.queue.len() {
            return None;
        }
        let from = (burst.arrival + 1).max(self.room_made(0));
        let first = QueuedBurst { burst: *burst, from };
        let column = self.column(&first, self.bank(&first));
        let gap = self.timing.gaps[0][0];
        let last = column.at + (count - 1) * gap;
        if last >= until || last >= column.until {
            return None;
        }
        self.command(burst, &column);
        let bank = &mut self.banks[burst.bank as usize];
        bank.free = bank.free.max(last + self.timing.recovery[0]);
        self.next = self.timing.gaps[0].map(|gap| last + gap);
        self.soonest = self.next[0].min(self.next[1]);
        for number in 1..count {
            self.commands.issue_column(column.at + number * gap);
        }
        for number in count.saturating_sub(self.columns.len() as u64)..count {
            let place = (self.served + number as usize) & (self.columns.len() - 1);
            self.columns[place] = column.at + number * gap;
        }
        self.served += count as usize;
        let queued = count * column.at.since(burst.arrival) + gap * (count * (count - 1) / 2);
        self.counts.rows.hits += count - 1;
        self.counts.queued += queued - column.at.since(burst.arrival);
        let data = self.timing.data[0];
        let from = Cycle(column.at.0 + data - self.timing.burst_cycles);
        Some(ServedRun { row: column.row, data: (from, last + data), queued })
    }
}
