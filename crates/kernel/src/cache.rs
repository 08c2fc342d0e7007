//! Caches (law 5): tags run ahead of the data, answers come in order.

use crate::counts::CacheCounts;
use crate::divisor::Divisor;
use crate::memory_events::CacheEvents;
use crate::{CacheConfig, Cycle};

/// Look-ups of a step, as far as they are settled.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PendingLookUps {
    /// Cycle of the last look-up.
    pub(crate) last: Cycle,
    /// Start of the step.
    pub(crate) start: Cycle,
    /// `request`: number of the last request that a look-up waits for, plus one, if its answer was unknown at the look-up;
    /// otherwise 0. `fill`: the last fill that was known.
    pub(crate) request: u64,
    pub(crate) fill: Cycle,
    /// Results of the look-ups, as far as they are known.
    pub(crate) counts: CacheCounts,
    /// Look-ups of lines with an earlier request whose answer was unknown. They become hits or merged look-ups.
    pub(crate) open: u32,
}

/// Marks an empty tag. No line has this number: addresses have 64 bits and lines at least 4 bytes.
const NO_LINE: u64 = u64::MAX;

/// One tag: the line and the request that fills it.
#[derive(Clone, Copy, Debug)]
struct Tag {
    line: u64,
    request: u64,
}

/// Tags of a cache: its lines, each with the request that fills it. Tags are independent of time.
#[derive(Clone, Debug)]
pub(crate) struct CacheTagArray {
    line: Divisor,
    sets: Divisor,
    ways: usize,
    /// `sets` runs of `ways` tags, most recently used first.
    tags: Vec<Tag>,
    /// True if every look-up hits.
    pub(crate) always_hits: bool,
    /// True if the look-ups of a step take several cycles; otherwise all are made at its start (law 5).
    pub(crate) spreads: bool,
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
            spreads: false,
        }
    }

    /// Returns true if look-ups give the same results in both caches from power-on.
    pub(crate) fn is_alike(&self, other: &Self) -> bool {
        let geometry = |tags: &Self| (tags.line, tags.sets, tags.ways, tags.always_hits, tags.spreads);
        geometry(self) == geometry(other)
    }

    /// Frees the tags. No look-up may follow.
    pub(crate) fn forget(&mut self) {
        self.tags = Vec::new();
    }

    /// Returns the first and last line that `bytes` at `address` touch.
    #[inline(always)]
    pub(crate) fn lines(&self, address: u64, bytes: u32) -> (u64, u64) {
        self.line.touched(address, bytes.max(1))
    }

    /// Looks up `line` and makes it the most recently used line of its set. Returns the number of the request that fills it.
    /// Returns `None` on a miss: request `next`, which the caller issues, will fill the line.
    #[inline(always)]
    pub(crate) fn look_up(&mut self, line: u64, next: u64) -> Option<u64> {
        if self.always_hits {
            return Some(0);
        }
        let (_, set) = self.sets.split(line);
        let tags = &mut self.tags[set as usize * self.ways..][..self.ways];
        // Usually the line is the most recently used one.
        if tags[0].line == line {
            return Some(tags[0].request);
        }
        // Each tag moves down by one until the line is found or the last tag is replaced.
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
    /// Look-up results by time, if a probe is attached.
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

    /// Returns the cycles that this many look-ups take.
    #[inline(always)]
    pub(crate) fn cycles(&self, look_ups: u32) -> u64 {
        let per_cycle = self.config.lookups_per_cycle.max(1);
        // Skips the division, which takes longer than everything else here.
        if look_ups <= per_cycle { 1 } else { look_ups.div_ceil(per_cycle).into() }
    }

    /// Returns the cycle of look-up `number` of a step that starts at `start`.
    #[inline]
    pub(crate) fn look_up_at(&self, start: Cycle, number: u32) -> Cycle {
        if self.tags.spreads { start + u64::from(number / self.config.lookups_per_cycle.max(1)) } else { start }
    }

    /// Makes this many look-ups (>= 1) of lines that are there, in a step that starts at `start`. Returns their answer time and the
    /// cycles that they take.
    #[inline(always)]
    pub(crate) fn hit(&mut self, start: Cycle, look_ups: u32) -> (Cycle, u64) {
        let cycles = self.cycles(look_ups);
        let last = if self.tags.spreads { start + (cycles - 1) } else { start };
        let counts = CacheCounts { hits: look_ups.into(), ..CacheCounts::default() };
        let answer = self.resolve(&PendingLookUps { start, last, counts, ..PendingLookUps::default() });
        (answer, cycles)
    }

    /// Accounts for look-ups whose fills are all known and returns their answer time. Answers come in order, so never before the
    /// previous one.
    #[inline(always)]
    pub(crate) fn resolve(&mut self, &PendingLookUps { start, last, fill, counts, .. }: &PendingLookUps) -> Cycle {
        self.counts.hits += counts.hits;
        self.counts.misses += counts.misses;
        self.counts.merged += counts.merged;
        if let Some(watch) = &mut self.watch {
            watch.note(start, self.counts);
        }
        self.answer = self.answer.max(last.max(fill) + u64::from(self.config.hit_latency));
        self.answer
    }
}
