//! Timing of a channel: the times that follow from its parameters, its banks, and the outcome of a column command.

use crate::counts::RowOutcome;
use crate::{Cycle, MemoryConfig};

/// Row number of a closed bank. No row has this number, because rows have at least 4 bytes.
pub(super) const CLOSED: u64 = u64::MAX;

/// One bank.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bank {
    pub(super) row: u64,
    /// Earliest column command since its activation.
    pub(super) ready: Cycle,
    /// Earliest precharge, or earliest activation if the bank is closed.
    pub(super) free: Cycle,
    /// The next refresh, which closes the bank.
    pub(super) until: Cycle,
}

/// The earliest column command of a burst, assuming that it is the next, and the row commands before it.
#[derive(Clone, Copy, Debug)]
pub(super) struct ColumnCommand {
    pub(super) at: Cycle,
    pub(super) row: RowOutcome,
    pub(super) activation: Cycle,
    /// The next refresh after it.
    pub(super) until: Cycle,
}

/// Times of a channel that follow from its parameters, by direction (read, write) where these differ.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChannelTiming {
    /// From a column command in one direction to the next in each direction.
    pub(super) gaps: [[u64; 2]; 2],
    /// From column command to the end of its data.
    pub(super) data: [u64; 2],
    /// From column command to precharge.
    pub(super) recovery: [u64; 2],
    pub(super) rcd: u64,
    pub(super) rp: u64,
    pub(super) ras: u64,
    pub(super) rrd: u64,
    pub(super) faw: u64,
    pub(super) refi: u64,
    pub(super) rfc: u64,
    pub(super) burst_cycles: u64,
}

impl ChannelTiming {
    pub(super) fn new(c: &MemoryConfig) -> Self {
        let [cl, cwl, burst] = [c.cl, c.cwl, c.burst_cycles].map(u64::from);
        let read_to_write = burst.max((cl + burst + 1).saturating_sub(cwl));
        let write_to_read = cwl + burst + u64::from(c.wtr);
        // Commands of a burst on a bounded command bus are in different cycles.
        let apart = c.commands_per_cycle.min(1);
        Self {
            gaps: [[burst, read_to_write], [write_to_read, burst]],
            data: [cl + burst, cwl + burst],
            recovery: [c.rtp.into(), cwl + burst + u64::from(c.wr)],
            rcd: c.rcd.max(apart).into(),
            rp: c.rp.max(apart).into(),
            ras: c.ras.into(),
            rrd: c.rrd.into(),
            faw: c.faw.into(),
            refi: c.refi.into(),
            rfc: c.rfc.into(),
            burst_cycles: burst,
        }
    }

    /// Returns a bank as the last refresh up to cycle `at` left it.
    #[cold]
    pub(super) fn refreshed(&self, at: Cycle) -> Bank {
        let last = Cycle(at.0 / self.refi * self.refi);
        Bank { row: CLOSED, ready: Cycle::ZERO, free: last + self.rfc, until: last + self.refi }
    }
}
