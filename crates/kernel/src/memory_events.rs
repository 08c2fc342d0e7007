//! Events of memories, kept for a probe until they are settled. Without a probe this costs nothing: each check is part of a check
//! that is needed anyway.

use crate::burst::Burst;
use crate::counts::RowOutcome;
use crate::{CacheCounts, Cycle};
use std::collections::VecDeque;

/// An event of a memory or of one of its clients. Memories and clients are numbered in the order of their addition. Intervals are
/// half-open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MemoryEvent {
    /// The bus of a channel moved a burst. Events are in order of time for each channel.
    Moved {
        /// Number of the memory.
        memory: usize,
        /// Number of the channel in the memory.
        channel: usize,
        /// Number of the client.
        client: usize,
        /// True for a posted write, false for a read.
        write: bool,
        /// The first cycle of its data.
        from: Cycle,
        /// The cycle after the last.
        to: Cycle,
    },
    /// A row was open from its activation to its precharge or a refresh. Events are in order of time for each bank.
    Open {
        /// Number of the memory.
        memory: usize,
        /// Number of the channel.
        channel: usize,
        /// Number of the bank in the channel.
        bank: usize,
        /// Number of the row in the bank.
        row: u64,
        /// Its activation.
        from: Cycle,
        /// The cycle in which it closed.
        to: Cycle,
    },
    /// Number of bursts that wait for their column command from cycle `at` on. Emitted on change; 0 before the first event.
    Queued {
        /// Number of the memory.
        memory: usize,
        /// Number of the channel.
        channel: usize,
        /// First cycle of the new number.
        at: Cycle,
        /// Number of bursts.
        bursts: usize,
    },
    /// Number of requests that have arrived and have no answer from cycle `at` on. Each holds a credit. Emitted on change; 0
    /// before the first event.
    InFlight {
        /// Number of the client.
        client: usize,
        /// First cycle of the new number.
        at: Cycle,
        /// Number of requests.
        requests: usize,
    },
    /// Results of the look-ups of the steps that started in a cycle. Events are in order of time for each client.
    LookedUp {
        /// Number of the client.
        client: usize,
        /// The start of the step.
        at: Cycle,
        /// Results.
        found: CacheCounts,
    },
}

impl MemoryEvent {
    /// Returns the source of the event as numbers. Events of one source come in order of time.
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

/// Bounds of the events that are settled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EventBounds {
    /// No step starts in this cycle or later, so the run may end in it.
    pub(crate) limit: Cycle,
    /// End of the run; `None` while it goes on.
    pub(crate) end: Option<Cycle>,
}

/// A number that goes up and down. Ups come in order of time, and so do downs, so all changes before the last of both are
/// settled.
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

    /// Emits each change since the last call with the new value, as far as changes are settled, or up to the end.
    pub(crate) fn emit(&mut self, EventBounds { limit, end }: EventBounds, mut emit: impl FnMut(Cycle, usize)) {
        let until = end.unwrap_or_else(|| self.last[0].min(self.last[1]).min(limit));
        while let Some(at) = self.ups.front().into_iter().chain(self.downs.front()).copied().min().filter(|at| *at < until) {
            let now = self.now + take_all(&mut self.ups, at) - take_all(&mut self.downs, at);
            if std::mem::replace(&mut self.now, now) != now {
                emit(at, now);
            }
        }
    }
}

/// Removes the front entries of this cycle and returns their number.
fn take_all(queue: &mut VecDeque<Cycle>, at: Cycle) -> usize {
    let count = queue.iter().take_while(|cycle| **cycle == at).count();
    queue.drain(..count);
    count
}

/// A row that is or was open.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OpenRow {
    pub(crate) bank: usize,
    pub(crate) row: u64,
    pub(crate) from: Cycle,
    pub(crate) to: Cycle,
}

/// Events of a channel.
#[derive(Clone, Debug)]
pub(crate) struct ChannelEvents {
    pub(crate) queue: Gauge,
    /// Bursts, each with the first cycle of its data and the cycle after the last.
    moved: Vec<(Burst, Cycle, Cycle)>,
    closed: Vec<OpenRow>,
    /// Cycle of the last activation, by bank.
    opened: Box<[Cycle]>,
}

impl ChannelEvents {
    pub(crate) fn new(banks: usize) -> Self {
        Self { queue: Gauge::default(), moved: vec![], closed: vec![], opened: vec![Cycle::ZERO; banks].into() }
    }

    /// Records the column command of a burst and its data interval.
    pub(crate) fn serve(&mut self, burst: Burst, column: Cycle, from: Cycle, to: Cycle) {
        self.queue.down(column);
        self.moved.push((burst, from, to));
    }

    /// Records an activation. If a row was open in the bank, it closed at `to`.
    #[cold]
    pub(crate) fn open(&mut self, bank: usize, before: Option<u64>, to: Cycle, activation: Cycle) {
        let from = std::mem::replace(&mut self.opened[bank], activation);
        self.closed.extend(before.map(|row| OpenRow { bank, row, from, to }));
    }

    /// Emits the events since the last call, and of bursts only those that have moved their data by `settled`. At the end of a run it
    /// includes all bursts, and the rows that are `left` open, each until its next refresh. Events are cut at the end.
    pub(crate) fn emit(
        &mut self,
        [memory, channel]: [usize; 2],
        left: impl Iterator<Item = (usize, u64, Cycle)>,
        settled: Cycle,
        bounds: EventBounds,
        mut emit: impl FnMut(MemoryEvent),
    ) {
        let EventBounds { limit, end } = bounds;
        // Bursts and rows that may last beyond the end of the run wait until the end is known.
        let (bursts_until, rows_until) = end.map_or((settled.min(limit), limit), |_| (Cycle::UNKNOWN, Cycle::UNKNOWN));
        let end_or = |to: Cycle| to.min(end.unwrap_or(to));
        let bursts = self.moved.partition_point(|(_, _, to)| *to <= bursts_until);
        for (burst, from, to) in self.moved.drain(..bursts) {
            let to = end_or(to);
            if from < to {
                emit(MemoryEvent::Moved { memory, channel, client: burst.client as usize, write: burst.write, from, to });
            }
        }
        if end.is_some() {
            let opened = &self.opened;
            self.closed.extend(left.map(|(bank, row, until)| OpenRow { bank, row, from: opened[bank], to: until }));
        }
        for OpenRow { bank, row, from, to } in self.closed.extract_if(.., |row| row.to <= rows_until) {
            let to = end_or(to);
            if from <= to {
                emit(MemoryEvent::Open { memory, channel, bank, row, from, to });
            }
        }
        self.queue.emit(bounds, |at, bursts| emit(MemoryEvent::Queued { memory, channel, at, bursts }));
    }
}

/// Returns the cycle in which the row before an activation closed: by its precharge, or by a refresh.
pub(crate) fn closed_at(row: RowOutcome, activation: Cycle, precharge: u64, refresh: Cycle) -> Cycle {
    if row == RowOutcome::Conflict { Cycle(activation.0 - precharge) } else { refresh }
}

/// Look-up results of a cache.
#[derive(Clone, Debug, Default)]
pub(crate) struct CacheEvents {
    seen: CacheCounts,
    new: Vec<(Cycle, CacheCounts)>,
}

impl CacheEvents {
    /// Assigns the look-ups since the last call to a step that started at `at`.
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

    /// Emits the results since the last call. Results of the last step are emitted only at the end, because more of them may
    /// follow.
    pub(crate) fn emit(&mut self, client: usize, at_end: bool, mut emit: impl FnMut(MemoryEvent)) {
        let settled = if at_end { self.new.len() } else { self.new.len().saturating_sub(1) };
        self.new.drain(..settled).for_each(|(at, found)| emit(MemoryEvent::LookedUp { client, at, found }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauge_emits_each_settled_change_once() {
        let (mut level, mut reported) = (Gauge::default(), vec![]);
        let until = |end| EventBounds { limit: Cycle::UNKNOWN, end };
        [0, 2, 2, 5].into_iter().for_each(|at| level.up(Cycle(at)));
        level.down(Cycle(2));
        level.emit(until(None), |at, n| reported.push((at.0, n)));
        assert_eq!(reported, [(0, 1)], "what comes in cycle 2 may still change");
        level.down(Cycle(5));
        level.down(Cycle(9));
        level.emit(until(None), |at, n| reported.push((at.0, n)));
        assert_eq!(reported, [(0, 1), (2, 2)]);
        level.emit(until(Some(Cycle(9))), |at, n| reported.push((at.0, n)));
        assert_eq!(reported, [(0, 1), (2, 2)], "one up and one down in cycle 5; nothing in cycle 9, where the run ends");
        level.emit(until(Some(Cycle(10))), |at, n| reported.push((at.0, n)));
        assert_eq!(reported, [(0, 1), (2, 2), (9, 1)]);
    }

    #[test]
    fn gauge_emits_changes_from_the_limit_on_at_the_end() {
        let (mut level, mut reported) = (Gauge::default(), vec![]);
        [1, 9].into_iter().for_each(|at| level.up(Cycle(at)));
        level.down(Cycle(7));
        level.emit(EventBounds { limit: Cycle(5), end: None }, |at, n| reported.push((at.0, n)));
        assert_eq!(reported, [(1, 1)]);
        level.emit(EventBounds { limit: Cycle(5), end: Some(Cycle(8)) }, |at, n| reported.push((at.0, n)));
        assert_eq!(reported, [(1, 1), (7, 0)], "the last step may run beyond the limit");
    }

    #[test]
    fn look_ups_of_one_step_are_emitted_together() {
        let counts = |hits, misses, merged| CacheCounts { hits, misses, merged };
        let (mut watch, mut reported) = (CacheEvents::default(), vec![]);
        for (at, seen) in [(3, counts(1, 0, 0)), (3, counts(1, 2, 0)), (4, counts(1, 2, 0)), (7, counts(1, 2, 1))] {
            watch.note(Cycle(at), seen);
        }
        watch.emit(5, false, |event| reported.push(event));
        assert_eq!(reported, [MemoryEvent::LookedUp { client: 5, at: Cycle(3), found: counts(1, 2, 0) }]);
        watch.emit(5, true, |event| reported.push(event));
        assert_eq!(reported[1], MemoryEvent::LookedUp { client: 5, at: Cycle(7), found: counts(0, 0, 1) });
    }
}
