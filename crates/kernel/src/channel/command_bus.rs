//! Command bus of a channel (law 4).
//!
//! Bursts are served in order of their column commands, and these are at least a cycle apart. So no command of an earlier burst is
//! in the cycle of a column command. Row commands may be issued ahead of column commands of others, in cycles with room.

use crate::Cycle;

/// Commands of a burst: a precharge, an activation, a column command.
const OF_BURST: usize = 3;

/// Recent commands of a channel.
#[derive(Clone, Debug)]
pub(super) struct CommandBus {
    /// Commands per cycle; 0 for any number.
    per_cycle: usize,
    /// Cycles of the commands of the bursts served last, as many as the window holds.
    recent: Box<[Cycle]>,
    next: usize,
    /// The last column command.
    latest: Cycle,
}

impl CommandBus {
    pub(super) fn new(per_cycle: u32, window: usize) -> Self {
        let commands = if per_cycle == 0 { 0 } else { OF_BURST * window };
        let recent = vec![Cycle::UNKNOWN; commands].into();
        Self { per_cycle: per_cycle as usize, recent, next: 0, latest: Cycle::ZERO }
    }

    /// Returns true if there is a limit.
    #[inline(always)]
    pub(super) fn is_limited(&self) -> bool {
        self.per_cycle > 0
    }

    /// Returns true if cycle `at` has room for one more command.
    #[inline]
    fn has_room(&self, at: Cycle) -> bool {
        at > self.latest || self.recent.iter().filter(|&&command| command == at).count() < self.per_cycle
    }

    /// Returns the first activation from `from` on, given the cycles from its precharge, if there is one.
    #[inline]
    pub(super) fn activation(&self, from: Cycle, precharge: Option<u64>) -> Cycle {
        let fits = |at: Cycle| self.has_room(at) && precharge.is_none_or(|rp| self.has_room(Cycle(at.0 - rp)));
        let mut at = from;
        while !fits(at) {
            at = at + 1;
        }
        at
    }

    /// Records the commands of a served burst.
    #[inline]
    pub(super) fn issue(&mut self, row: impl Iterator<Item = Cycle>, column: Cycle) {
        row.for_each(|at| self.record(at));
        self.issue_column(column);
    }

    /// Records the only command of a served burst. Does nothing without a limit.
    #[inline]
    pub(super) fn issue_column(&mut self, column: Cycle) {
        if self.is_limited() {
            self.record(column);
            self.latest = column;
        }
    }

    #[inline]
    fn record(&mut self, at: Cycle) {
        self.recent[self.next] = at;
        self.next = if self.next + 1 == self.recent.len() { 0 } else { self.next + 1 };
    }
}
