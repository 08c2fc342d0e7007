//! The cycles of a critical path, by cause.

use super::MachineTiming;
use crate::Cycle;
use crate::critical_path::{CriticalPath, PathPart, PathSegment, RequestPhase, StageGroups};
use std::collections::BTreeMap;

/// The cause of passing cycles, with the number of a stage, FIFO or client.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SegmentCause {
    Occupancy(usize),
    Latency(usize),
    Fifo(usize),
    Slot(usize),
    Memory(usize, RequestPhase),
    Rest,
}

impl SegmentCause {
    /// Iterates over all causes in a machine, in the order of their places.
    fn all(time: &MachineTiming) -> impl Iterator<Item = Self> + use<> {
        let [stages, fifos, clients] = counts_of(time);
        let units = (0..stages).map(Self::Occupancy).chain((0..stages).map(Self::Latency));
        let fifos = (0..fifos).map(Self::Fifo).chain((0..fifos).map(Self::Slot));
        let requests = (0..clients).flat_map(|client| RequestPhase::ALL.map(|phase| Self::Memory(client, phase)));
        units.chain(fifos).chain(requests).chain([Self::Rest])
    }

    /// Place among all causes of a machine with these numbers of stages, FIFOs and clients.
    #[inline]
    fn place(self, [stages, fifos, clients]: [usize; 3]) -> usize {
        match self {
            Self::Occupancy(stage) => stage,
            Self::Latency(stage) => stages + stage,
            Self::Fifo(fifo) => 2 * stages + fifo,
            Self::Slot(fifo) => 2 * stages + fifos + fifo,
            Self::Memory(client, phase) => 2 * (stages + fifos) + client * RequestPhase::ALL.len() + phase as usize,
            Self::Rest => 2 * (stages + fifos) + clients * RequestPhase::ALL.len(),
        }
    }
}

/// The cycles of a path, summed on the way back.
#[derive(Debug)]
pub(super) struct PathCycles {
    /// Ends of the spans between marks.
    ends: Vec<u64>,
    counts: [usize; 3],
    /// By [place](SegmentCause::place) of the cause, with one sum per span; empty without a segment.
    by_cause: Vec<Vec<u64>>,
    /// Groups of steps, by stage.
    groups: Vec<Vec<u32>>,
    /// By group. The cycles after a step, up to the next one with a group, belong to that step.
    by_group: BTreeMap<u32, u64>,
    /// Cycles behind the steps so far, which belong to the step before.
    behind: u64,
}

impl PathCycles {
    /// Begins with no cycles. `ends`: ends of the spans between marks. `groups`: groups of steps, by stage.
    pub(super) fn new(time: &MachineTiming, ends: Vec<u64>, groups: Vec<Vec<u32>>) -> Self {
        let counts = counts_of(time);
        let by_cause = vec![Vec::new(); SegmentCause::all(time).count()];
        Self { ends, counts, by_cause, groups, by_group: BTreeMap::new(), behind: 0 }
    }

    /// Adds the segments from a time to an event: to the start of a `step`, with its stage and number, or to another event.
    pub(super) fn add(&mut self, step: Option<(usize, u32)>, begin: Cycle, segments: &[(Cycle, SegmentCause)]) {
        let mut from = begin;
        for &(to, cause) in segments {
            let by_span = &mut self.by_cause[cause.place(self.counts)];
            by_span.resize(self.ends.len(), 0);
            add_by_span(&self.ends, from.0, to.0, by_span);
            from = to;
        }
        if let Some((stage, number)) = step
            && let Some(&group) = self.groups.get(stage).and_then(|groups| groups.get(number as usize))
        {
            *self.by_group.entry(group).or_default() += std::mem::take(&mut self.behind);
        }
        self.behind += from.since(begin);
    }

    /// Returns the path, once all its segments are added.
    pub(super) fn into_path(mut self, time: &MachineTiming) -> CriticalPath {
        let part = |(cause, by_mark): (SegmentCause, Vec<u64>)| {
            let cycles = by_mark.iter().sum();
            (cycles > 0).then(|| PathPart { stretch: named_segment(cause, time), cycles, by_mark })
        };
        let mut parts: Vec<PathPart> = SegmentCause::all(time).zip(self.by_cause).filter_map(part).collect();
        // A stable sort keeps ties in the order of the block diagram.
        parts.sort_by_key(|part| std::cmp::Reverse(part.cycles));
        if !self.groups.is_empty() {
            *self.by_group.entry(StageGroups::NONE).or_default() += self.behind;
        }
        let by_group = self.by_group.into_iter().filter(|(_, cycles)| *cycles > 0).collect();
        CriticalPath { cycles: self.ends.last().copied().unwrap_or_default(), parts, by_group }
    }
}

/// Numbers of stages, FIFOs and clients of a machine.
fn counts_of(time: &MachineTiming) -> [usize; 3] {
    [time.stages.len(), time.fifos.len(), time.memories.clients().len()]
}

/// Adds the cycles between two times to the spans in which they lie. Each span ends at one of `ends`. (Found by binary search,
/// because there may be thousands of marks and millions of events.)
fn add_by_span(ends: &[u64], mut from: u64, to: u64, by_span: &mut [u64]) {
    let first = ends.partition_point(|end| *end <= from);
    for (end, sum) in ends.iter().zip(by_span).skip(first) {
        if from >= to {
            break;
        }
        let until = to.min(*end);
        *sum += until - from;
        from = until;
    }
}

fn named_segment(cause: SegmentCause, time: &MachineTiming) -> PathSegment {
    let unit = |stage: usize| time.shape.stages[stage].names.name.clone();
    let fifo = |fifo: usize| time.shape.fifos[fifo].name.clone();
    match cause {
        SegmentCause::Occupancy(stage) => PathSegment::Occupancy(unit(stage)),
        SegmentCause::Latency(stage) => PathSegment::Latency(unit(stage)),
        SegmentCause::Fifo(number) => PathSegment::Fifo(fifo(number)),
        SegmentCause::Slot(number) => PathSegment::Slot(fifo(number)),
        SegmentCause::Memory(client, phase) => {
            PathSegment::Memory(time.memories.client_names().nth(client).unwrap_or_default().to_owned(), phase)
        }
        SegmentCause::Rest => PathSegment::Rest,
    }
}
