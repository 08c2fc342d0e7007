//! The critical path: the terms of law 3 that bound each start form a chain of waits and work from the end of a run back to its
//! first cycle.
//!
//! Every step is an event, and so is every token that becomes visible. Each event has one predecessor. The cycles in between are
//! segments with one cause each, for example the phases of a request. If several terms are equal, one is chosen, so the path is
//! not unique.

use super::fifo_timing::DeliveredToken;
use super::path_tracer::{NO_STEP, PathTracer, StartTerm, TracedStep};
use super::{FifoTiming, MachineTiming};
use crate::Cycle;
use crate::critical_path::{CriticalPath, PathPart, PathSegment, RequestPhase, StageGroups};
use crate::port::Completion;
use std::cell::Ref;
use std::collections::BTreeMap;

/// The cause of passing cycles, with the number of a stage, FIFO or client.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum SegmentCause {
    Occupancy(usize),
    Latency(usize),
    Fifo(usize),
    Slot(usize),
    Memory(usize, RequestPhase),
    Rest,
}

/// An event on the path.
#[derive(Clone, Copy, Debug)]
enum PathEvent {
    /// Power-on.
    Begin,
    /// A step of a stage starts.
    Step(usize, u32),
    /// A token of a FIFO becomes visible.
    Token(usize, u32),
    /// The end of the path.
    End,
}

impl PathTracer {
    /// Returns the path back from the last mark, or from the end of a run of `total` cycles without marks. `marks`: cycles between
    /// marks. `groups`: groups of the steps of each stage; may be empty. Returns `None` if there were too many steps.
    pub(crate) fn path(&self, time: &MachineTiming, total: u64, marks: &[u64], groups: &[StageGroups]) -> Option<CriticalPath> {
        if !self.has_all() {
            return None;
        }
        let sum_up = |sum: &mut u64, cycles: &u64| {
            *sum += cycles;
            Some(*sum)
        };
        let ends: Vec<u64> = if marks.is_empty() { vec![total] } else { marks.iter().scan(0, sum_up).collect() };
        let tokens = time.fifos.iter().map(FifoTiming::kept_tokens).collect();
        let end = Cycle(ends.last().copied().unwrap_or_default());
        let mut walk = PathWalk { time, steps: self, tokens, end, segments: Vec::new(), reached: Cycle::ZERO };
        let groups = groups.iter().map(|groups| groups.clone().into_steps().collect()).collect();
        let mut cycles = PathCycles { ends, by_cause: BTreeMap::new(), groups, by_group: BTreeMap::new(), behind: 0 };
        walk.back(&mut cycles);
        Some(cycles.into_path(time))
    }
}

/// A walk from event to event, back from the end.
struct PathWalk<'a> {
    time: &'a MachineTiming,
    steps: &'a PathTracer,
    tokens: Vec<Ref<'a, Vec<DeliveredToken>>>,
    end: Cycle,
    /// Segments from an event to the next, in order: the end of each, and its cause.
    segments: Vec<(Cycle, SegmentCause)>,
    /// End of the last segment, or time of the event before them.
    reached: Cycle,
}

impl PathWalk<'_> {
    fn back(&mut self, cycles: &mut PathCycles) {
        let mut event = PathEvent::End;
        while !matches!(event, PathEvent::Begin) {
            self.segments.clear();
            let before = self.segments_to(event);
            cycles.add(event, self.time_of(before), &self.segments);
            event = before;
        }
    }

    fn time_of(&self, event: PathEvent) -> Cycle {
        match event {
            PathEvent::Begin => Cycle::ZERO,
            PathEvent::Step(stage, number) => self.step(stage, number).start,
            PathEvent::Token(fifo, number) => self.tokens[fifo][number as usize].visible,
            PathEvent::End => self.end,
        }
    }

    fn step(&self, stage: usize, number: u32) -> TracedStep {
        self.steps.stages[stage][number as usize]
    }

    /// Finds the segments that end with an event. Returns the event with which they begin.
    fn segments_to(&mut self, event: PathEvent) -> PathEvent {
        match event {
            PathEvent::Begin => event,
            PathEvent::Step(stage, number) => self.segments_to_step(stage, number),
            PathEvent::Token(fifo, number) => self.segments_to_token(fifo, number),
            PathEvent::End => self.segments_to_end(),
        }
    }

    /// Begins the segments with an event.
    fn begin(&mut self, event: PathEvent) -> PathEvent {
        self.reached = self.time_of(event);
        event
    }

    /// Adds the segment up to the event itself.
    fn finish(&mut self, from: PathEvent, at: Cycle, cause: SegmentCause) -> PathEvent {
        self.segments.push((at, cause));
        from
    }

    /// Adds a segment up to a time, unless that is reached already.
    fn reach(&mut self, at: Cycle, cause: SegmentCause) {
        if at > self.reached {
            self.reached = at;
            self.segments.push((at, cause));
        }
    }

    /// Adds the segments to the start of a step.
    fn segments_to_step(&mut self, stage: usize, number: u32) -> PathEvent {
        let TracedStep { start, bound_by, .. } = self.step(stage, number);
        let clock = &self.time.stages[stage];
        let before = number.checked_sub(1).map_or(PathEvent::Begin, |last| PathEvent::Step(stage, last));
        match bound_by {
            StartTerm::Free => self.finish(before, start, SegmentCause::Occupancy(stage)),
            StartTerm::Answer(own) => {
                let client = clock.clients[usize::from(own)];
                let from = self.begin(before);
                self.add_request(self.time.memories.last_received(client, start), client, start);
                self.finish(from, start, SegmentCause::Memory(client, RequestPhase::Order))
            }
            StartTerm::Token(input, token) => {
                let fifo = clock.inputs.at(usize::from(input));
                self.finish(PathEvent::Token(fifo, token), start, SegmentCause::Fifo(fifo))
            }
            StartTerm::Credit(own, request) => {
                let client = clock.clients[usize::from(own)];
                let issued = self.steps.issued[client].get(request as usize).filter(|step| **step != NO_STEP);
                let from = self.begin(issued.map_or(PathEvent::Begin, |&step| PathEvent::Step(stage, step)));
                self.add_request(self.time.memories.last_answered(client, start), client, start);
                self.finish(from, start, SegmentCause::Memory(client, RequestPhase::Order))
            }
            StartTerm::Slot(output, token) => {
                let fifo = clock.outputs.at(usize::from(output));
                let taken = PathEvent::Step(self.time.shape.fifos[fifo].consumer, self.steps.fifos[fifo].taken[token as usize]);
                self.finish(taken, start, SegmentCause::Slot(fifo))
            }
            StartTerm::Rest => self.finish(before, start, SegmentCause::Rest),
        }
    }

    /// Adds the segments until a token becomes visible.
    fn segments_to_token(&mut self, fifo: usize, number: u32) -> PathEvent {
        let shape = &self.time.shape.fifos[fifo];
        let DeliveredToken { delivered, visible, last_client } = self.tokens[fifo][number as usize];
        let before = number.checked_sub(1).map_or(PathEvent::Begin, |last| PathEvent::Token(fifo, last));
        let from = if delivered + shape.latency <= self.time_of(before) {
            // One token becomes visible per cycle.
            before
        } else {
            let client = self.time.shape.stages[shape.producer].clients.get(usize::from(last_client)).copied();
            self.segments_to_delivery(shape.producer, self.steps.fifos[fifo].made[number as usize], client, delivered)
        };
        self.finish(from, visible, SegmentCause::Fifo(fifo))
    }

    /// Adds the segments until a step delivers at `at`. If that is later than without memory, `client` gave the last answer.
    fn segments_to_delivery(&mut self, stage: usize, number: u32, client: Option<usize>, at: Cycle) -> PathEvent {
        let TracedStep { start, latency, after_data, .. } = self.step(stage, number);
        let (base, cause) = (start + u64::from(latency), SegmentCause::Latency(stage));
        let from = self.begin(PathEvent::Step(stage, number));
        let Some(client) = client.filter(|_| at > base) else {
            self.reach(base, cause);
            return from;
        };
        let answer = Cycle(at.since(Cycle(after_data.into())));
        self.reach(base.min(answer), cause);
        self.add_request(self.time.memories.last_received(client, answer), client, answer);
        self.reach(at, cause);
        from
    }

    /// Adds the phases of a request whose data came at `at`.
    fn add_request(&mut self, request: Option<Completion>, client: usize, at: Cycle) {
        let Some(request) = request else { return };
        let phases = [
            (request.arrival + 1, RequestPhase::Arrival),
            (request.row, RequestPhase::Bus),
            (request.column, RequestPhase::Bank),
            (request.end, RequestPhase::Data),
            (request.answer, RequestPhase::Order),
            (at, RequestPhase::Cache),
        ];
        for (until, phase) in phases {
            self.reach(until.min(at), SegmentCause::Memory(client, phase));
        }
    }

    /// Adds the segments to the end: from the delivery of the last marked step, or from the end of the stage that was busy last.
    fn segments_to_end(&mut self) -> PathEvent {
        let MachineTiming { stages, memories, .. } = self.time;
        let last_of = |stage: usize| self.steps.stages[stage].len().checked_sub(1).map(|last| last as u32);
        let last = (0..stages.len()).max_by_key(|&stage| stages[stage].free);
        let from = if let Some((stage, number)) = self.steps.marked {
            let TracedStep { start, latency, after_data, .. } = self.step(stage, number);
            let at = stages[stage].marks.iter().copied().max().unwrap_or(start + u64::from(latency));
            let answer = Cycle(at.since(Cycle(after_data.into())));
            let client = stages[stage].clients.iter().copied().find(|&client| memories.is_answer(client, answer));
            self.segments_to_delivery(stage, number, client, at)
        } else if let Some((stage, number)) = last.and_then(|stage| Some((stage, last_of(stage)?))) {
            self.finish(PathEvent::Step(stage, number), stages[stage].free, SegmentCause::Occupancy(stage))
        } else {
            PathEvent::Begin
        };
        self.finish(from, self.end, SegmentCause::Rest)
    }
}

/// The cycles of a path, summed on the way back.
struct PathCycles {
    /// Ends of the spans between marks.
    ends: Vec<u64>,
    /// By cause, with one sum per span.
    by_cause: BTreeMap<SegmentCause, Vec<u64>>,
    /// Groups of steps, by stage.
    groups: Vec<Vec<u32>>,
    /// By group. The cycles after a step, up to the next one with a group, belong to that step.
    by_group: BTreeMap<u32, u64>,
    /// Cycles behind the steps so far, which belong to the step before.
    behind: u64,
}

impl PathCycles {
    /// Adds the segments from a time to an event.
    fn add(&mut self, event: PathEvent, begin: Cycle, segments: &[(Cycle, SegmentCause)]) {
        let mut from = begin;
        for &(to, cause) in segments {
            let by_span = self.by_cause.entry(cause).or_insert_with(|| vec![0; self.ends.len()]);
            add_by_span(&self.ends, from.0, to.0, by_span);
            from = to;
        }
        if let PathEvent::Step(stage, number) = event
            && let Some(&group) = self.groups.get(stage).and_then(|groups| groups.get(number as usize))
        {
            *self.by_group.entry(group).or_default() += std::mem::take(&mut self.behind);
        }
        self.behind += from.since(begin);
    }

    fn into_path(mut self, time: &MachineTiming) -> CriticalPath {
        let part = |(cause, by_mark): (SegmentCause, Vec<u64>)| {
            let cycles = by_mark.iter().sum();
            (cycles > 0).then(|| PathPart { stretch: named_segment(cause, time), cycles, by_mark })
        };
        let mut parts: Vec<PathPart> = self.by_cause.into_iter().filter_map(part).collect();
        // A stable sort keeps ties in the order of the block diagram.
        parts.sort_by_key(|part| std::cmp::Reverse(part.cycles));
        if !self.groups.is_empty() {
            *self.by_group.entry(StageGroups::NONE).or_default() += self.behind;
        }
        let by_group = self.by_group.into_iter().filter(|(_, cycles)| *cycles > 0).collect();
        CriticalPath { cycles: self.ends.last().copied().unwrap_or_default(), parts, by_group }
    }
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
