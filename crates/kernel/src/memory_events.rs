//! What memories do, kept for a probe until it is settled. Kept only where one looks on: what is here costs nothing otherwise, as it is
//! asked for where something else is asked for anyway.

use crate::channel::Burst;
use crate::counts::RowOutcome;
use crate::{CacheCounts, Cycle};
use std::collections::VecDeque;

/// What a memory or one of its clients did. Memories and clients are numbered in the order in which they were added; intervals are
/// half-open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MemoryEvent {
    /// The bus of a channel moved a burst; in order of time for each channel.
    Moved {
        /// Of this memory.
        memory: usize,
        /// Its number there.
        channel: usize,
        /// Of this client.
        client: usize,
        /// Posted write rather than read.
        write: bool,
        /// The first cycle of its data.
        from: Cycle,
        /// The cycle after the last.
        to: Cycle,
    },
    /// A row was open, from its activation to its precharge or a refresh; in order of time for each bank.
    Open {
        /// Of this memory.
        memory: usize,
        /// Of this channel.
        channel: usize,
        /// Number of the bank there.
        bank: usize,
        /// Number of the row there.
        row: u64,
        /// Its activation.
        from: Cycle,
        /// When it was closed.
        to: Cycle,
    },
    /// So many bursts have arrived and wait for their column command from a cycle on; told where that changes. Before the first there
    /// are none.
    Queued {
        /// Of this memory.
        memory: usize,
        /// In this channel.
        channel: usize,
        /// From here on.
        at: Cycle,
        /// How many.
        bursts: usize,
    },
    /// So many requests have arrived and have no answer from a cycle on: each holds a credit. Told where that changes; before the first
    /// there are none.
    InFlight {
        /// Of this client.
        client: usize,
        /// From here on.
        at: Cycle,
        /// How many.
        requests: usize,
    },
    /// What the look-ups of a step found that started in a cycle; in order of time for each client.
    LookedUp {
        /// Of this client.
        client: usize,
        /// The start of the step.
        at: Cycle,
        /// What they found.
        found: CacheCounts,
    },
}

impl MemoryEvent {
    /// What it is of, in numbers: events of one source come in order of time.
    pub fn source(&self) -> [usize; 4] {
        match *self {
            Self::Moved { memory, channel, .. } => [0, memory, channel, 0],
            Self::Open { memory, channel, bank, .. } => [1, memory, channel, bank],
            Self::Queued { memory, channel, .. } => [2, memory, channel, 0],
            Self::InFlight { client, .. } => [3, client, 0, 0],
            Self::LookedUp { client, .. } => [4, client, 0, 0],
        }
    }
}

/// A number that goes up and down. Ups come in order of time, and so do downs: all before the last of both are settled.
#[derive(Clone, Debug, Default)]
pub(crate) struct Gauge {
    ups: VecDeque<Cycle>,
    downs: VecDeque<Cycle>,
    last: [Cycle; 2],
    now: usize,
}

impl Gauge {
    pub(crate) fn up(&mut self, at: Cycle) {
        self.ups.push_back(at);
        self.last[0] = at;
    }

    pub(crate) fn down(&mut self, at: Cycle) {
        self.downs.push_back(at);
        self.last[1] = at;
    }

    /// Tells where it has changed since the last call, and to what: as far as that is settled, or up to `end`.
    pub(crate) fn emit(&mut self, end: Option<Cycle>, mut emit: impl FnMut(Cycle, usize)) {
        let until = end.unwrap_or(self.last[0].min(self.last[1]));
        while let Some(at) = self.ups.front().into_iter().chain(self.downs.front()).copied().min().filter(|at| *at < until) {
            let now = self.now + take_all(&mut self.ups, at) - take_all(&mut self.downs, at);
            if std::mem::replace(&mut self.now, now) != now {
                emit(at, now);
            }
        }
    }
}

/// Takes out those in front that are of this cycle; how many there were.
fn take_all(queue: &mut VecDeque<Cycle>, at: Cycle) -> usize {
    let count = queue.iter().take_while(|cycle| **cycle == at).count();
    queue.drain(..count);
    count
}

/// A row that is open, or was.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OpenRow {
    pub(crate) bank: usize,
    pub(crate) row: u64,
    pub(crate) from: Cycle,
    pub(crate) to: Cycle,
}

/// What a channel does.
#[derive(Clone, Debug)]
pub(crate) struct ChannelEvents {
    pub(crate) queue: Gauge,
    /// Bursts, each with the first cycle of its data and the one after the last.
    moved: Vec<(Burst, Cycle, Cycle)>,
    closed: Vec<OpenRow>,
    /// When the row of each bank was opened last.
    opened: Box<[Cycle]>,
}

impl ChannelEvents {
    pub(crate) fn new(banks: usize) -> Self {
        Self { queue: Gauge::default(), moved: vec![], closed: vec![], opened: vec![Cycle::ZERO; banks].into() }
    }

    /// A burst had its column command, and its data move.
    pub(crate) fn serve(&mut self, burst: Burst, column: Cycle, (from, to): (Cycle, Cycle)) {
        self.queue.down(column);
        self.moved.push((burst, from, to));
    }

    /// A bank is activated, which was closed at `to` if a row was open there.
    #[cold]
    pub(crate) fn open(&mut self, bank: usize, before: Option<u64>, to: Cycle, activation: Cycle) {
        let from = std::mem::replace(&mut self.opened[bank], activation);
        self.closed.extend(before.map(|row| OpenRow { bank, row, from, to }));
    }

    /// Tells what there was since the last call; at the end of a run, with the rows that are `left` open, each until it would be
    /// refreshed.
    pub(crate) fn emit(
        &mut self,
        [memory, channel]: [usize; 2],
        left: impl Iterator<Item = (usize, u64, Cycle)>,
        end: Option<Cycle>,
        mut emit: impl FnMut(MemoryEvent),
    ) {
        for (burst, from, to) in self.moved.drain(..) {
            emit(MemoryEvent::Moved { memory, channel, client: burst.client as usize, write: burst.write, from, to });
        }
        if let Some(end) = end {
            let opened = &self.opened;
            self.closed.extend(left.map(|(bank, row, until)| OpenRow { bank, row, from: opened[bank], to: until.min(end) }));
        }
        for OpenRow { bank, row, from, to } in self.closed.drain(..) {
            emit(MemoryEvent::Open { memory, channel, bank, row, from, to });
        }
        self.queue.emit(end, |at, bursts| emit(MemoryEvent::Queued { memory, channel, at, bursts }));
    }
}

/// When the row before an activation was closed: ahead of its precharge, or by a refresh.
pub(crate) fn closed_at(row: RowOutcome, activation: Cycle, precharge: u64, refresh: Cycle) -> Cycle {
    if row == RowOutcome::Conflict { Cycle(activation.0 - precharge) } else { refresh }
}

/// What the look-ups in a cache found.
#[derive(Clone, Debug, Default)]
pub(crate) struct CacheEvents {
    seen: CacheCounts,
    new: Vec<(Cycle, CacheCounts)>,
}

impl CacheEvents {
    /// The look-ups since the last call were of a step that started at `at`.
    #[cold]
    pub(crate) fn note(&mut self, at: Cycle, counts: CacheCounts) {
        let seen = std::mem::replace(&mut self.seen, counts);
        let found = CacheCounts {
            hits: counts.hits - seen.hits,
            misses: counts.misses - seen.misses,
            merged: counts.merged - seen.merged,
        };
        if found == CacheCounts::default() {
            return;
        }
        match self.new.last_mut() {
            Some((last, sum)) if *last == at => {
                *sum = CacheCounts {
                    hits: sum.hits + found.hits,
                    misses: sum.misses + found.misses,
                    merged: sum.merged + found.merged,
                };
            }
            _ => self.new.push((at, found)),
        }
    }

    /// Tells what there was since the last call; of the last step only at the end, as more of it may follow.
    pub(crate) fn emit(&mut self, client: usize, at_end: bool, mut emit: impl FnMut(MemoryEvent)) {
        let settled = if at_end { self.new.len() } else { self.new.len().saturating_sub(1) };
        self.new.drain(..settled).for_each(|(at, found)| emit(MemoryEvent::LookedUp { client, at, found }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_is_told_once_where_it_changes_and_as_far_as_it_is_settled() {
        let (mut level, mut told) = (Gauge::default(), vec![]);
        [0, 2, 2, 5].into_iter().for_each(|at| level.up(Cycle(at)));
        level.down(Cycle(2));
        level.emit(None, |at, n| told.push((at.0, n)));
        assert_eq!(told, [(0, 1)], "what comes in cycle 2 may still change");
        level.down(Cycle(5));
        level.down(Cycle(9));
        level.emit(None, |at, n| told.push((at.0, n)));
        assert_eq!(told, [(0, 1), (2, 2)]);
        level.emit(Some(Cycle(9)), |at, n| told.push((at.0, n)));
        assert_eq!(told, [(0, 1), (2, 2)], "one up and one down in cycle 5; nothing in cycle 9, where the run ends");
        level.emit(Some(Cycle(10)), |at, n| told.push((at.0, n)));
        assert_eq!(told, [(0, 1), (2, 2), (9, 1)]);
    }

    #[test]
    fn look_ups_of_one_step_are_told_together() {
        let counts = |hits, misses, merged| CacheCounts { hits, misses, merged };
        let (mut watch, mut told) = (CacheEvents::default(), vec![]);
        for (at, seen) in [(3, counts(1, 0, 0)), (3, counts(1, 2, 0)), (4, counts(1, 2, 0)), (7, counts(1, 2, 1))] {
            watch.note(Cycle(at), seen);
        }
        watch.emit(5, false, |event| told.push(event));
        assert_eq!(told, [MemoryEvent::LookedUp { client: 5, at: Cycle(3), found: counts(1, 2, 0) }]);
        watch.emit(5, true, |event| told.push(event));
        assert_eq!(told[1], MemoryEvent::LookedUp { client: 5, at: Cycle(7), found: counts(0, 0, 1) });
    }
}
