//! Caches (law 5): tags run ahead of the data, answers come in order.

use crate::memory::Divisor;
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

/// A look-up whose answer is not accounted for yet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LookUp {
    /// Start of its step.
    pub(crate) start: Cycle,
    /// The memory request that fills the line, and when its answer is there, if that was known at the look-up.
    pub(crate) request: u64,
    pub(crate) fill: Cycle,
    pub(crate) missed: bool,
}

/// Number of no line: addresses have 64 bits, and lines at least 4 bytes.
const NO_LINE: u64 = u64::MAX;

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
    line: Divisor,
    sets: Divisor,
    /// `sets` runs of `ways` tags, most recently used first.
    tags: Vec<Tag>,
    answer: Cycle,
    pub(crate) counts: CacheCounts,
}

impl Cache {
    pub(crate) fn new(name: &str, config: &CacheConfig) -> Self {
        let (sets, ways) = (config.sets.max(1) as usize, config.ways.max(1) as usize);
        Self {
            name: name.into(),
            line: Divisor::new(config.line_bytes),
            sets: Divisor::new(config.sets),
            tags: vec![Tag { line: NO_LINE, request: 0 }; sets * ways],
            config: config.clone(),
            answer: Cycle::ZERO,
            counts: CacheCounts::default(),
        }
    }

    /// First and last line that `bytes` at `address` touch.
    #[inline(always)]
    pub(crate) fn lines(&self, address: u64, bytes: u32) -> (u64, u64) {
        let last = address + u64::from(bytes.max(1)) - 1;
        (self.line.split(address).0, self.line.split(last).0)
    }

    /// Cycles that this many look-ups take.
    #[inline(always)]
    pub(crate) fn cycles(&self, look_ups: usize) -> u64 {
        let per_cycle = self.config.lookups_per_cycle.max(1) as usize;
        // A division takes longer than all the rest.
        if look_ups <= per_cycle { 1 } else { look_ups.div_ceil(per_cycle) as u64 }
    }

    /// Looks `line` up and makes it the most recently used of its set: the number of the request that fills it. `None` where
    /// it is not there: it will be filled by request `next`, which the caller issues.
    #[inline(always)]
    pub(crate) fn look_up(&mut self, line: u64, next: u64) -> Option<u64> {
        let (_, set) = self.sets.split(line);
        let ways = self.config.ways as usize;
        let tags = &mut self.tags[set as usize * ways..][..ways];
        // Mostly it is the one used last.
        if tags[0].line == line {
            return Some(tags[0].request);
        }
        // Each tag moves one down, until the line is found or the last falls out.
        let mut carried = std::mem::replace(&mut tags[0], Tag { line, request: next });
        for tag in &mut tags[1..] {
            std::mem::swap(&mut carried, tag);
            if carried.line == line {
                tags[0].request = carried.request;
                return Some(carried.request);
            }
        }
        None
    }

    /// Accounts for a look-up whose fill is known, and gives its answer: in order, so never before the one ahead.
    #[inline(always)]
    pub(crate) fn resolve(&mut self, look_up: &LookUp, fill: Cycle) -> Cycle {
        let start = look_up.start;
        let count = match (look_up.missed, fill > start) {
            (true, _) => &mut self.counts.misses,
            (false, true) => &mut self.counts.merged,
            (false, false) => &mut self.counts.hits,
        };
        *count += 1;
        self.answer = self.answer.max(start.max(fill) + u64::from(self.config.hit_latency));
        self.answer
    }
}
