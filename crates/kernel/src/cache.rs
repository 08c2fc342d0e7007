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

/// One tag: the line, the request that fills it, and the step that looked it up last.
#[derive(Clone, Copy, Debug)]
struct Tag {
    line: u64,
    request: u64,
    step: u64,
}

/// What a look-up found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Found {
    /// The step has looked the line up before: nothing happens.
    Before,
    /// The line, filled by this request.
    Line(u64),
    /// No such line.
    Nothing,
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
    /// Number of the step that looks up now, its look-ups so far, and those of its lines that it has itself replaced.
    step: u64,
    look_ups: u32,
    replaced: Vec<u64>,
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
            tags: vec![Tag { line: NO_LINE, request: 0, step: 0 }; sets * ways],
            step: 0,
            look_ups: 0,
            replaced: Vec::new(),
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

    /// The look-ups that follow are of another step.
    #[inline(always)]
    pub(crate) fn begin_step(&mut self) {
        self.step += 1;
        self.look_ups = 0;
        self.replaced.clear();
    }

    /// Cycles that the look-ups of the step take.
    #[inline(always)]
    pub(crate) fn cycles(&self) -> u64 {
        let per_cycle = self.config.lookups_per_cycle.max(1);
        // A division takes longer than all the rest.
        if self.look_ups <= per_cycle { 1 } else { u64::from(self.look_ups.div_ceil(per_cycle)) }
    }

    /// Looks `line` up and makes it the most recently used of its set. If it is not there, it will be filled by request
    /// `next`, which the caller issues.
    #[inline(always)]
    pub(crate) fn look_up(&mut self, line: u64, next: u64) -> Found {
        let (_, set) = self.sets.split(line);
        let ways = self.config.ways as usize;
        let tags = &mut self.tags[set as usize * ways..][..ways];
        // Mostly it is the one used last.
        if tags[0].line == line {
            return Self::touch(&mut tags[0], self.step, &mut self.look_ups);
        }
        let Some(at) = tags.iter().position(|t| t.line == line) else { return self.fill(line, next) };
        if tags[at].step != self.step {
            // Each tag before it moves one down.
            for i in (0..at).rev() {
                tags.swap(i, i + 1);
            }
            return Self::touch(&mut tags[0], self.step, &mut self.look_ups);
        }
        Found::Before
    }

    #[inline(always)]
    fn touch(tag: &mut Tag, step: u64, look_ups: &mut u32) -> Found {
        if tag.step == step {
            return Found::Before;
        }
        tag.step = step;
        *look_ups += 1;
        Found::Line(tag.request)
    }

    /// Replaces the least recently used line of a set.
    fn fill(&mut self, line: u64, next: u64) -> Found {
        if self.replaced.contains(&line) {
            return Found::Before;
        }
        let (_, set) = self.sets.split(line);
        let ways = self.config.ways as usize;
        let tags = &mut self.tags[set as usize * ways..][..ways];
        let last = tags[ways - 1];
        if last.step == self.step && last.line != NO_LINE {
            self.replaced.push(last.line);
        }
        tags.copy_within(..ways - 1, 1);
        tags[0] = Tag { line, request: next, step: self.step };
        self.look_ups += 1;
        Found::Nothing
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
