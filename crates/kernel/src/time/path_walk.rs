//! The critical path: the terms of law 3 that bound each start form a chain of waits and work from the end of a run back to its
//! first cycle.
//!
//! Every step is an event, and so is every token that becomes visible. Each event has one predecessor. The cycles in between are
//! segments with one cause each, for example the phases of a request. If several terms are equal, one is chosen, so the path is
//! not unique.

use super::kept_tokens::{AnsweredDelivery, KeptTokens};
use super::path_cycles::{PathCycles, SegmentCause};
use super::path_tracer::{PathTracer, StartTerm};
use super::stage_cursor::StageCursor;
use super::{CompactStep, FifoTiming, MachineTiming, StageClock};
use crate::Cycle;
use crate::critical_path::{CriticalPath, RequestPhase, StageGroups};
use crate::port::Completion;
use crate::report::RunReport;
use std::borrow::Cow;
use std::cell::Ref;

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
    /// Returns the path back from the last mark of a run, or from its end if it has no marks. `steps`: all steps, by stage. `groups`:
    /// groups of the steps of each stage; may be empty. Returns `None` if there were too many steps.
    pub(crate) fn path(
        &self,
        time: &MachineTiming,
        steps: &[Cow<'_, [CompactStep]>],
        RunReport { total, marks, .. }: &RunReport,
        groups: &[StageGroups],
    ) -> Option<CriticalPath> {
        if !self.has_all() {
            return None;
        }
        let sum_up = |sum: &mut u64, cycles: &u64| {
            *sum += cycles;
            Some(*sum)
        };
        let ends: Vec<u64> = if marks.is_empty() { vec![*total] } else { marks.iter().scan(0, sum_up).collect() };
        let tokens = time.fifos.iter().map(FifoTiming::kept_tokens).collect();
        let end = Cycle(ends.last().copied().unwrap_or_default());
        let stages = steps.iter().zip(&self.stages).enumerate();
        let cursors = stages.map(|(stage, (steps, traced))| StageCursor::at_end(time, stage, steps, traced)).collect();
        let mut walk = PathWalk { time, steps: self, tokens, cursors, end, segments: Vec::new(), reached: Cycle::ZERO };
        let groups = groups.iter().map(|groups| groups.clone().into_steps().collect()).collect();
        let mut cycles = PathCycles::new(time, ends, groups);
        walk.back(&mut cycles);
        Some(cycles.into_path(time))
    }
}

/// A walk from event to event, back from the end.
struct PathWalk<'a> {
    time: &'a MachineTiming,
    steps: &'a PathTracer,
    /// By FIFO.
    tokens: Vec<Ref<'a, KeptTokens>>,
    /// By stage.
    cursors: Vec<StageCursor<'a>>,
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
            let step = if let PathEvent::Step(stage, number) = event { Some((stage, number)) } else { None };
            cycles.add(step, self.time_of(before), &self.segments);
            event = before;
        }
    }

    fn time_of(&mut self, event: PathEvent) -> Cycle {
        match event {
            PathEvent::Begin => Cycle::ZERO,
            PathEvent::Step(stage, number) => self.cursor_at(stage, number).start(),
            PathEvent::Token(fifo, number) => self.tokens[fifo].visible[number as usize],
            PathEvent::End => self.end,
        }
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
        let clock = &self.time.stages[stage];
        let cursor = self.cursor_at(stage, number);
        let (start, bound_by) = (cursor.start(), cursor.bound_by());
        let before = number.checked_sub(1).map_or(PathEvent::Begin, |last| PathEvent::Step(stage, last));
        match bound_by {
            StartTerm::Free => self.finish(before, start, SegmentCause::Occupancy(stage)),
            StartTerm::Answer(own) => {
                let client = clock.clients[usize::from(own)];
                let from = self.begin(before);
                self.add_request(self.time.memories.last_received(client, start), client, start);
                self.finish(from, start, SegmentCause::Memory(client, RequestPhase::Order))
            }
            StartTerm::Token(input) => {
                let (fifo, token) = (clock.inputs.at(usize::from(input)), self.cursor_at(stage, number).taken(input));
                self.finish(PathEvent::Token(fifo, token), start, SegmentCause::Fifo(fifo))
            }
            StartTerm::Credit(own) => {
                let client = clock.clients[usize::from(own)];
                let from = self.issue_of_credit(stage, number, usize::from(own));
                let from = self.begin(from);
                self.add_request(self.time.memories.last_answered(client, start), client, start);
                self.finish(from, start, SegmentCause::Memory(client, RequestPhase::Order))
            }
            StartTerm::Slot(output) => {
                let fifo = clock.outputs.at(usize::from(output));
                let made = self.cursor_at(stage, number).made(output);
                let holder = made.saturating_sub(self.time.shape.fifos[fifo].depth as u32);
                let taken = self.step_that_takes(fifo, holder);
                self.finish(taken, start, SegmentCause::Slot(fifo))
            }
            StartTerm::Rest => self.finish(before, start, SegmentCause::Rest),
        }
    }

    /// Returns the cursor of a stage, moved back to a step.
    fn cursor_at(&mut self, stage: usize, number: u32) -> &StageCursor<'_> {
        let cursor = &mut self.cursors[stage];
        cursor.go_back(|cursor| cursor.number() > number);
        cursor
    }

    /// Returns the step that takes a token of a FIFO.
    fn step_that_takes(&mut self, fifo: usize, token: u32) -> PathEvent {
        let stage = self.time.shape.fifos[fifo].consumer;
        let input = self.time.stages[stage].inputs.place_of(fifo);
        let cursor = &mut self.cursors[stage];
        cursor.go_back(|cursor| cursor.taken(input) > token);
        PathEvent::Step(stage, cursor.number())
    }

    /// Returns the step that makes a token of a FIFO.
    fn step_that_makes(&mut self, fifo: usize, token: u32) -> u32 {
        let stage = self.time.shape.fifos[fifo].producer;
        let output = self.time.stages[stage].outputs.place_of(fifo);
        let cursor = &mut self.cursors[stage];
        cursor.go_back(|cursor| cursor.made(output) > token);
        cursor.number()
    }

    /// Returns the step whose request, once answered, gave a step the last credit that it needed of its client `own`.
    fn issue_of_credit(&self, stage: usize, number: u32, own: usize) -> PathEvent {
        let StageClock { clients, needs, .. } = &self.time.stages[stage];
        let issuers = &self.steps.issuers[clients[own]];
        let issued = issuers.partition_point(|issuer| *issuer < number) as u64;
        let request = self.time.memories.credit_of(clients[own], issued, needs.credits[own]);
        issuers.get(request as usize).map_or(PathEvent::Begin, |&step| PathEvent::Step(stage, step))
    }

    /// Adds the segments until a token becomes visible.
    fn segments_to_token(&mut self, fifo: usize, number: u32) -> PathEvent {
        let shape = &self.time.shape.fifos[fifo];
        let visible = self.time_of(PathEvent::Token(fifo, number));
        let before = number.checked_sub(1).map_or(PathEvent::Begin, |last| PathEvent::Token(fifo, last));
        let step = self.step_that_makes(fifo, number);
        let (delivered, client) = match self.tokens[fifo].deliveries.get(number as usize) {
            Some(&AnsweredDelivery { at, last_client }) => {
                (at, self.time.stages[shape.producer].clients.get(usize::from(last_client)).copied())
            }
            None => (self.base_of(shape.producer, step), None),
        };
        let from = if delivered + shape.latency <= self.time_of(before) {
            // One token becomes visible per cycle.
            before
        } else {
            self.segments_to_delivery(shape.producer, step, client, delivered)
        };
        self.finish(from, visible, SegmentCause::Fifo(fifo))
    }

    /// Returns the delivery of a step without memory.
    fn base_of(&mut self, stage: usize, number: u32) -> Cycle {
        let clock = &self.time.stages[stage];
        let cursor = self.cursor_at(stage, number);
        cursor.start() + clock.known_timing(&cursor.timing()).1
    }

    /// Adds the segments until a step delivers at `at`. If that is later than without memory, `client` gave the last answer.
    fn segments_to_delivery(&mut self, stage: usize, number: u32, client: Option<usize>, at: Cycle) -> PathEvent {
        let (base, cause) = (self.base_of(stage, number), SegmentCause::Latency(stage));
        let after_data = self.cursor_at(stage, number).timing().after_data;
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
        if self.time.memories.controls_periodic(client) {
            self.reach(at.min(request.arrival + 1), SegmentCause::Memory(client, RequestPhase::Arrival));
            return self.reach(at, SegmentCause::Memory(client, RequestPhase::Periodic));
        }
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
        let last_of = |stage: usize| self.steps.stages[stage].steps.len().checked_sub(1).map(|last| last as u32);
        let last = (0..stages.len()).max_by_key(|&stage| stages[stage].free);
        let from = if let Some((stage, number)) = self.steps.marked {
            let (base, made) = (self.base_of(stage, number), self.cursor_at(stage, number).timing());
            let at = stages[stage].marks.iter().copied().max().unwrap_or(base);
            let answer = Cycle(at.since(Cycle(made.after_data.into())));
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
