//! The critical path: the terms of law 3 that bound each start form a chain of waits and work from the end of a run back to its
//! first cycle.
//!
//! Every step is an event, and so is every token that becomes visible and every phase of a request that such an event waits for.
//! Each event has one predecessor, and the cycles in between have one cause. If several terms are equal, one is chosen: the
//! unit's own occupancy before its tokens, and tokens before credits and slots. So the path is not unique.

use super::stage_visit::StageView;
use super::{InputMask, MachineTiming, StepTiming};
use crate::capacity::MAX_CLIENTS;
use crate::critical_path::{CriticalPath, PathPart, PathSegment, RequestPhase, StageGroups};
use crate::netlist::Netlist;
use crate::{Cycle, MemorySystem};
use std::collections::{BTreeMap, VecDeque};

/// Stands before the first event.
const NONE: u32 = u32::MAX;

/// The cause of passing cycles, with the number of a stage, FIFO or client.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum EventCause {
    Occupancy(u16),
    Latency(u16),
    Fifo(u16),
    Slot(u16),
    Memory(u16, RequestPhase),
    Rest,
}

/// An event `at` a time, with its cause and its predecessor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathEvent {
    at: Cycle,
    after: u32,
    why: EventCause,
}

/// A step that delivers later.
#[derive(Clone, Copy, Debug)]
struct PendingDelivery {
    /// Its event.
    step: u32,
    /// Its stage.
    stage: usize,
    /// Its delivery without memory.
    base: Cycle,
    /// Cycles from the last answer to the delivery, at least.
    after_data: u64,
}

/// Tokens of a FIFO.
#[derive(Clone, Debug)]
struct FifoTokens {
    /// Tokens inside: the step that made each.
    inside: VecDeque<PendingDelivery>,
    /// The token that became visible last.
    visible: u32,
    /// Steps that took the last tokens, as many as there are slots.
    pops: VecDeque<u32>,
}

impl FifoTokens {
    /// Returns the step that freed the slot of the next token. That pop lies as many tokens back as there are slots, less the
    /// tokens inside.
    fn slot_freed_by(&self, depth: usize) -> u32 {
        let ago = depth.saturating_sub(self.inside.len());
        self.pops.len().checked_sub(ago).and_then(|at| self.pops.get(at)).copied().unwrap_or(NONE)
    }
}

/// Events of a run so far.
pub(crate) struct PathTracer {
    events: Vec<PathEvent>,
    /// Maximum number of events. Longer runs have no path.
    max_events: usize,
    /// Last step of each stage.
    steps: Vec<u32>,
    fifos: Vec<FifoTokens>,
    /// The step that issued each request, by client.
    issued: Vec<Vec<u32>>,
    /// The last step that passes a mark.
    mark: Option<PendingDelivery>,
    /// Groups of the steps to come, by stage; and events of grouped steps, with their groups.
    groups: Vec<Box<dyn Iterator<Item = u32>>>,
    of_groups: Vec<(u32, u32)>,
}

impl PathTracer {
    /// Creates a tracer at the begin of a run that keeps at most `most` events, in the memory of an earlier tracer. `groups`: groups of
    /// the steps of each stage; may be empty.
    pub(crate) fn new(time: &mut MachineTiming, (most, mut events): (usize, Vec<PathEvent>), groups: &[StageGroups]) -> Self {
        time.memories.keep_answers();
        let tokens = FifoTokens { inside: VecDeque::new(), visible: NONE, pops: VecDeque::new() };
        events.clear();
        Self {
            events,
            max_events: most.min(NONE as usize - 16),
            steps: vec![NONE; time.stages.len()],
            fifos: vec![tokens; time.fifos.len()],
            issued: vec![Vec::new(); time.memories.clients().len()],
            mark: None,
            groups: groups.iter().map(|groups| Box::new(groups.clone().into_steps()) as _).collect(),
            of_groups: vec![],
        }
    }

    fn push(&mut self, at: Cycle, after: u32, why: EventCause) -> u32 {
        self.events.push(PathEvent { at, after, why });
        self.events.len() as u32 - 1
    }

    fn time_of(&self, event: u32) -> Cycle {
        self.events.get(event as usize).map_or(Cycle::ZERO, |event| event.at)
    }

    /// Records a step before timing takes it in. (Kept out of line, so that runs without a path pay nothing.)
    #[cold]
    #[inline(never)]
    pub(crate) fn step(&mut self, shape: &Netlist, visit: &StageView<'_>, (at, takes): (Cycle, InputMask), made: &StepTiming) {
        if self.events.len() > self.max_events {
            return;
        }
        let &StageView { stage, clock, memories, .. } = visit;
        // All its requests by now came from its last step at the latest.
        for &client in &clock.clients {
            self.issued[client].resize(memories.issued(client) as usize, self.steps[stage]);
        }
        let inputs = takes.inputs();
        for (_, fifo) in clock.inputs.of(inputs) {
            let visible = self.push_visibility(shape, visit, fifo);
            self.fifos[fifo].visible = visible;
        }
        let (after, why) = self.start_cause(shape, visit, (at, inputs));
        let event = self.push(at, after, why);
        self.steps[stage] = event;
        if let Some(group) = self.groups.get_mut(stage).and_then(Iterator::next) {
            self.of_groups.push((event, group));
        }
        for (_, fifo) in clock.inputs.of(inputs) {
            let tokens = &mut self.fifos[fifo];
            tokens.pops.push_back(event);
            if tokens.pops.len() > shape.fifos[fifo].depth {
                tokens.pops.pop_front();
            }
        }
        let (base, after_data) = (at + clock.known_timing(made).1, made.after_data.into());
        let delivering = PendingDelivery { step: event, stage, base, after_data };
        for (_, fifo) in clock.outputs.of(made.outputs) {
            self.fifos[fifo].inside.push_back(delivering);
        }
        if made.marked {
            self.mark = Some(delivering);
        }
    }

    /// Returns the term of law 3 that bound a start, and the event of that term.
    fn start_cause(&mut self, shape: &Netlist, visit: &StageView<'_>, (at, inputs): (Cycle, u32)) -> (u32, EventCause) {
        let &StageView { stage, clock, fifos, memories } = visit;
        if clock.free == at {
            return (self.steps[stage], EventCause::Occupancy(stage as u16));
        }
        if clock.block.until == at
            && let Some(client) = clock.block.last(at).map(|own| clock.clients[own])
        {
            let answered = self.push_answer(memories, client, (self.steps[stage], at));
            return (answered, EventCause::Memory(client as u16, RequestPhase::Order));
        }
        for (_, fifo) in clock.inputs.of(inputs) {
            if fifos[fifo].front_visible() == at {
                return (self.fifos[fifo].visible, EventCause::Fifo(fifo as u16));
            }
        }
        for (&client, &credits) in clock.clients.iter().zip(&clock.needs.credits) {
            if memories.credits_at(client, credits) == at {
                let number = memories.credit_of(client, credits);
                let issued = self.issued[client].get(number as usize).copied().unwrap_or(NONE);
                let answered = self.push_answer(memories, client, (issued, at));
                return (answered, EventCause::Memory(client as u16, RequestPhase::Order));
            }
        }
        for (_, fifo) in clock.outputs.of(clock.outputs.all()) {
            if fifos[fifo].room_at() == at {
                return (self.fifos[fifo].slot_freed_by(shape.fifos[fifo].depth), EventCause::Slot(fifo as u16));
            }
        }
        (self.steps[stage], EventCause::Rest)
    }

    /// Records that the front token of a FIFO, which is popped now, became visible.
    fn push_visibility(&mut self, shape: &Netlist, visit: &StageView<'_>, fifo: usize) -> u32 {
        let nothing = PendingDelivery { step: NONE, stage: shape.fifos[fifo].producer, base: Cycle::ZERO, after_data: 0 };
        let made = self.fifos[fifo].inside.pop_front().unwrap_or(nothing);
        let slots = &visit.fifos[fifo];
        let (visible, why) = (slots.front_visible(), EventCause::Fifo(fifo as u16));
        let (latest, delivered) = latest_answer(slots.front_answers().as_ref(), &made);
        let before = self.fifos[fifo].visible;
        if delivered + shape.fifos[fifo].latency <= self.time_of(before) {
            // One token becomes visible per cycle.
            return self.push(visible, before, why);
        }
        let client = latest.map(|own| shape.stages[made.stage].clients[own]);
        let after = self.push_delivery(visit.memories, &made, (client, delivered));
        self.push(visible, after, why)
    }

    /// Records the delivery of a step at `at`. If it was later than without memory, `client` gave the last answer.
    fn push_delivery(&mut self, memories: &MemorySystem, made: &PendingDelivery, (client, at): (Option<usize>, Cycle)) -> u32 {
        let &PendingDelivery { step, stage, base, after_data } = made;
        let why = EventCause::Latency(stage as u16);
        let latency = |path: &mut Self, until: Cycle, after| {
            if until > path.time_of(after) { path.push(until, after, why) } else { after }
        };
        let Some(client) = client else { return latency(self, base, step) };
        let answer = Cycle(at.0 - after_data);
        let ready = latency(self, base.min(answer), step);
        let answered = self.push_answer(memories, client, (ready, answer));
        latency(self, at, answered)
    }

    /// Records the phases of the request that a client got last by `at`, after an event.
    fn push_answer(&mut self, memories: &MemorySystem, client: usize, (mut after, at): (u32, Cycle)) -> u32 {
        let Some(request) = memories.last_answered(client, at) else { return after };
        let phases = [
            (request.arrival + 1, RequestPhase::Arrival),
            (request.row, RequestPhase::Bus),
            (request.column, RequestPhase::Bank),
            (request.end, RequestPhase::Data),
            (request.answer, RequestPhase::Order),
            (at, RequestPhase::Cache),
        ];
        for (until, phase) in phases {
            let until = until.min(at);
            if until > self.time_of(after) {
                after = self.push(until, after, EventCause::Memory(client as u16, phase));
            }
        }
        after
    }

    /// Returns the path back from the last mark, or from the end of a run of `total` cycles without marks. `marks`: cycles
    /// between marks. Returns `None` if there were too many events.
    pub(crate) fn trace(&mut self, time: &MachineTiming, total: u64, marks: &[u64]) -> Option<CriticalPath> {
        let last = self.last(time);
        if self.events.len() > self.max_events {
            return None;
        }
        let end: u64 = if marks.is_empty() { total } else { marks.iter().sum() };
        let mut event = self.push(Cycle(end), last, EventCause::Rest);
        let spans = if marks.is_empty() { &[total] } else { marks };
        let sum_up = |sum: &mut u64, cycles: &u64| {
            *sum += cycles;
            Some(*sum)
        };
        let ends: Vec<u64> = spans.iter().scan(0, sum_up).collect();
        let mut spent: BTreeMap<EventCause, Vec<u64>> = BTreeMap::new();
        let mut by_group = ByGroup::default();
        while let Some(&PathEvent { at, after, why }) = self.events.get(event as usize) {
            by_group.pass(self.group(event), at.since(self.time_of(after)));
            let by_mark = spent.entry(why).or_insert_with(|| vec![0; ends.len()]);
            add_by_span(&ends, (self.time_of(after).0, at.0), by_mark);
            event = after;
        }
        let part = |(why, by_mark): (EventCause, Vec<u64>)| {
            let cycles = by_mark.iter().sum();
            (cycles > 0).then(|| PathPart { stretch: named_segment(why, time), cycles, by_mark })
        };
        let mut parts: Vec<PathPart> = spent.into_iter().filter_map(part).collect();
        // A stable sort keeps ties in the order of the block diagram.
        parts.sort_by_key(|part| std::cmp::Reverse(part.cycles));
        let by_group = if self.groups.is_empty() { vec![] } else { by_group.finish() };
        Some(CriticalPath { cycles: end, parts, by_group })
    }

    /// Returns the memory of the events, for the next tracer.
    pub(crate) fn into_events(self) -> Vec<PathEvent> {
        self.events
    }

    /// Returns the group of an event, if it is a step of one.
    fn group(&self, event: u32) -> Option<u32> {
        let place = self.of_groups.binary_search_by_key(&event, |(event, _)| *event).ok()?;
        Some(self.of_groups[place].1)
    }

    /// Returns the event that the end of the run waits for.
    fn last(&mut self, time: &MachineTiming) -> u32 {
        if let Some(made) = self.mark {
            let clock = &time.stages[made.stage];
            let at = clock.marks.iter().copied().max().unwrap_or(made.base);
            let answer = Cycle(at.since(Cycle(made.after_data)));
            let client = clock.clients.iter().copied().find(|&client| time.memories.is_answer(client, answer));
            return self.push_delivery(&time.memories, &made, (client.filter(|_| at > made.base), at));
        }
        let stage = (0..time.stages.len()).max_by_key(|&stage| time.stages[stage].free);
        let Some(stage) = stage.filter(|&stage| self.steps[stage] != NONE) else { return NONE };
        self.push(time.stages[stage].free, self.steps[stage], EventCause::Occupancy(stage as u16))
    }
}

/// Cycles of a path by group, summed on the way back. The cycles after a step, up to the next one, belong to that step.
#[derive(Default)]
struct ByGroup {
    sums: BTreeMap<u32, u64>,
    behind: u64,
}

impl ByGroup {
    /// Passes an event, which may be a step of a group, and the cycles before it.
    fn pass(&mut self, group: Option<u32>, ahead: u64) {
        if let Some(group) = group {
            *self.sums.entry(group).or_default() += std::mem::take(&mut self.behind);
        }
        self.behind += ahead;
    }

    fn finish(mut self) -> Vec<(u32, u64)> {
        self.pass(Some(StageGroups::NONE), 0);
        self.sums.into_iter().filter(|(_, cycles)| *cycles > 0).collect()
    }
}

/// Returns the client, as the unit numbers it, whose answer determined the delivery, and the delivery; `None` if no answer did.
fn latest_answer(answers: Option<&[Cycle; MAX_CLIENTS]>, made: &PendingDelivery) -> (Option<usize>, Cycle) {
    let answers = answers.into_iter().flatten().enumerate().filter(|(_, answer)| **answer > Cycle::ZERO);
    answers.fold((None, made.base), |best, (own, &answer)| {
        let delivered = answer + made.after_data;
        if delivered > best.1 { (Some(own), delivered) } else { best }
    })
}

/// Adds the cycles between two times to the spans in which they lie. Each span ends at one of `ends`. (Found by binary search,
/// because there may be thousands of marks and millions of events.)
fn add_by_span(ends: &[u64], (mut from, to): (u64, u64), by_mark: &mut [u64]) {
    let first = ends.partition_point(|end| *end <= from);
    for (end, sum) in ends.iter().zip(by_mark).skip(first) {
        if from >= to {
            break;
        }
        let until = to.min(*end);
        *sum += until - from;
        from = until;
    }
}

fn named_segment(why: EventCause, time: &MachineTiming) -> PathSegment {
    let unit = |stage: u16| time.shape.stages[usize::from(stage)].names.name.clone();
    let fifo = |fifo: u16| time.shape.fifos[usize::from(fifo)].name.clone();
    match why {
        EventCause::Occupancy(stage) => PathSegment::Occupancy(unit(stage)),
        EventCause::Latency(stage) => PathSegment::Latency(unit(stage)),
        EventCause::Fifo(number) => PathSegment::Fifo(fifo(number)),
        EventCause::Slot(number) => PathSegment::Slot(fifo(number)),
        EventCause::Memory(client, phase) => {
            let name = time.memories.client_names().nth(usize::from(client)).unwrap_or_default();
            PathSegment::Memory(name.to_owned(), phase)
        }
        EventCause::Rest => PathSegment::Rest,
    }
}
