//! Caches (law 5): tags run ahead of the data, answers come in order.

use crate::{CacheConfig, Cycle};
use serde::{Deserialize, Serialize};

/// What a cache's look-ups found. hits + misses + merged = look-ups.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct CacheCounts {
    /// The line was there.
    pub hits: u64,
    /// The line was requested from memory.
    pub misses: u64,
    /// The line was on its way.
    pub merged: u64,
}

/// When a line's data come: with memory request `0`, or at a time already known.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Fill {
    Request(u64),
    Known(Cycle),
}

/// A look-up whose answer is not accounted for yet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LookUp {
    pub(crate) line: u64,
    pub(crate) start: Cycle,
    pub(crate) fill: Fill,
    pub(crate) missed: bool,
}

/// One tag: the line and the request that fills it.
#[derive(Clone, Copy, Debug)]
struct Tag {
    line: u64,
    request: u64,
}

/// A cache in front of one memory port.
#[derive(Clone, Debug)]
pub(crate) struct Cache {
    pub(crate) name: String,
    pub(crate) config: CacheConfig,
    /// `sets` runs of `ways` tags, least recently used first; `filled[set]` of them in use.
    tags: Vec<Tag>,
    filled: Vec<u32>,
    answer: Cycle,
    pub(crate) counts: CacheCounts,
}

impl Cache {
    pub(crate) fn new(name: &str, config: &CacheConfig) -> Self {
        let (sets, ways) = (config.sets.max(1) as usize, config.ways.max(1) as usize);
        Self {
            name: name.into(),
            tags: vec![Tag { line: 0, request: 0 }; sets * ways],
            filled: vec![0; sets],
            config: config.clone(),
            answer: Cycle::ZERO,
            counts: CacheCounts::default(),
        }
    }

    /// Looks `line` up and makes it the most recently used of its set. On a miss `issue` makes the memory request and
    /// gives its number. Returns that number and whether it was a miss.
    #[inline]
    pub(crate) fn look_up(&mut self, line: u64, issue: impl FnOnce() -> u64) -> (u64, bool) {
        let sets = self.filled.len() as u64;
        let set = (if sets.is_power_of_two() { line & (sets - 1) } else { line % sets }) as usize;
        let ways = self.config.ways as usize;
        let filled = self.filled[set] as usize;
        let tags = &mut self.tags[set * ways..][..ways];
        if let Some(at) = tags[..filled].iter().rposition(|t| t.line == line) {
            let request = tags[at].request;
            tags[at..filled].rotate_left(1);
            return (request, false);
        }
        let request = issue();
        if filled == ways {
            tags.rotate_left(1);
        } else {
            self.filled[set] += 1;
        }
        tags[self.filled[set] as usize - 1] = Tag { line, request };
        (request, true)
    }

    /// Accounts for a look-up whose fill is known, and gives its answer: in order, so never before the one ahead.
    #[inline]
    pub(crate) fn resolve(&mut self, look_up: LookUp, fill: Cycle) -> Cycle {
        let in_flight = fill > look_up.start;
        let count = match (look_up.missed, in_flight) {
            (true, _) => &mut self.counts.misses,
            (false, true) => &mut self.counts.merged,
            (false, false) => &mut self.counts.hits,
        };
        *count += 1;
        self.answer = self.answer.max(look_up.start.max(fill) + u64::from(self.config.hit_latency));
        self.answer
    }
}
