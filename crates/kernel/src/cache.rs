//! Caches (law 5): tags run ahead of the data, answers come in order.

use crate::counts::CacheCounts;
use crate::divisor::Divisor;
use crate::memory_events::CacheEvents;
use crate::{CacheConfig, Cycle};

/// Look-ups of a step, as far as they are settled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PendingLookUps {
    /// Start of the step.
    pub(crate) start: Cycle,
    /// Number of the last request that one of them waits for, plus one, where its answer was not known when they were made; and the
    /// last fill that was.
    pub(crate) request: u64,
    pub(crate) fill: Cycle,
    /// What they found, as far as it is known.
    pub(crate) counts: CacheCounts,
    /// How many of those that were held wait for a request whose answer was not known: hits or merged.
    pub(crate) open: u32,
}

/// Number of no line: addresses have 64 bits, and lines at least 4 bytes.
const NO_LINE: u64 = u64::MAX;

/// One tag: the line and the request that fills it.
#[derive(Clone, Copy, Debug)]
struct Tag {
    line: u64,
    request: u64,
}

/// The tags of a cache: which lines it has, and by which requests. They know of no time.
#[derive(Clone, Debug)]
pub(crate) struct CacheTagArray {
    line: Divisor,
    sets: Divisor,
    ways: usize,
    /// `sets` runs of `ways` tags, most recently used first.
    tags: Vec<Tag>,
    /// Every line is there.
    pub(crate) always_hits: bool,
}

impl CacheTagArray {
    fn new(config: &CacheConfig) -> Self {
        let (sets, ways) = (config.sets.max(1) as usize, config.ways.max(1) as usize);
        Self {
            line: Divisor::new(config.line_bytes),
            sets: Divisor::new(config.sets),
            ways,
            tags: vec![Tag { line: NO_LINE, request: 0 }; sets * ways],
            always_hits: config.always_hits,
        }
    }

    /// Whether look-ups find the same here and there, from power-on.
    pub(crate) fn is_alike(&self, other: &Self) -> bool {
        let geometry = |tags: &Self| (tags.line, tags.sets, tags.ways, tags.always_hits);
        geometry(self) == geometry(other)
    }

    /// Forgets all lines: nothing will be looked up again.
    pub(crate) fn forget(&mut self) {
        self.tags = Vec::new();
    }

    /// First and last line that `bytes` at `address` touch.
    #[inline(always)]
    pub(crate) fn lines(&self, address: u64, bytes: u32) -> (u64, u64) {
        self.line.touched(address, bytes.max(1))
    }

    /// Looks `line` up and makes it the most recently used of its set: the number of the request that fills it. `None` where
    /// it is not there: it will be filled by request `next`, which the caller issues.
    #[inline(always)]
    pub(crate) fn look_up(&mut self, line: u64, next: u64) -> Option<u64> {
        if self.always_hits {
            return Some(0);
        }
        let (_, set) = self.sets.split(line);
        let tags = &mut self.tags[set as usize * self.ways..][..self.ways];
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
}

/// A cache in front of one memory port.
#[derive(Clone, Debug)]
pub(crate) struct Cache {
    pub(crate) name: String,
    pub(crate) config: CacheConfig,
    pub(crate) tags: CacheTagArray,
    answer: Cycle,
    pub(crate) counts: CacheCounts,
    /// What look-ups found when, where a probe looks on.
    pub(crate) watch: Option<Box<CacheEvents>>,
}

impl Cache {
    pub(crate) fn new(name: &str, config: &CacheConfig) -> Self {
        Self {
            name: name.into(),
            tags: CacheTagArray::new(config),
            config: config.clone(),
            answer: Cycle::ZERO,
            counts: CacheCounts::default(),
            watch: None,
        }
    }

    /// Cycles that this many look-ups take.
    #[inline(always)]
    pub(crate) fn cycles(&self, look_ups: u32) -> u64 {
        let per_cycle = self.config.lookups_per_cycle.max(1);
        // A division takes longer than all the rest.
        if look_ups <= per_cycle { 1 } else { look_ups.div_ceil(per_cycle).into() }
    }

    /// Accounts for look-ups whose fills are all known by `fill`, and gives their answer: in order, so never before the one ahead.
    #[inline(always)]
    pub(crate) fn resolve(&mut self, start: Cycle, fill: Cycle, counts: CacheCounts) -> Cycle {
        self.counts.hits += counts.hits;
        self.counts.misses += counts.misses;
        self.counts.merged += counts.merged;
        if let Some(watch) = &mut self.watch {
            watch.note(start, self.counts);
        }
        self.answer = self.answer.max(start.max(fill) + u64::from(self.config.hit_latency));
        self.answer
    }
}
