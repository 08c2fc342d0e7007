//! The probe: joins adjacent events, cuts them to the window, and passes them to the sinks.

use crate::layout::TimelineLayout;
use crate::levels::{ChannelCounters, CounterList, CounterValue, RATE_CYCLES};
use basrelief_kernel::{CacheCounts, Cycle, Interval, MemoryEvent, Outcome, Probe, RunReport, StallCause};
use std::io;

/// State of a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnitState {
    /// It is kept by a step.
    Busy,
    /// It waits.
    Waits(StallCause),
    /// The unit executes no further step, but other units do.
    Done,
}

/// Attribution of a step, as far as it is known. A stall has the attribution of the step that ends it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StepAttribution {
    /// Number of the frame, from 0.
    pub frame: Option<u32>,
    /// Number of the object.
    pub object: Option<u32>,
    /// Number of the polygon in its frame, from 0.
    pub polygon: Option<u32>,
    /// MIP level of the first of its pixels.
    pub level: Option<u8>,
    /// Memory clients of the stage that the step uses, one bit each. 0 for a stall.
    pub asks: u32,
    /// Token of the step, if its life is recorded.
    pub life: Option<TokenLife>,
}

impl StepAttribution {
    /// Returns the numbers with their names. Frames are counted from 1, as in reports.
    pub(crate) fn numbers(&self) -> [(&'static str, Option<u64>); 4] {
        let frame = self.frame.map(|frame| u64::from(frame) + 1);
        let [object, polygon, level] = [self.object, self.polygon, self.level.map(u32::from)].map(|number| number.map(u64::from));
        [("frame", frame), ("object", object), ("polygon", polygon), ("level", level)]
    }

    /// Returns the names of the memory clients that the step uses, from those of its stage.
    pub(crate) fn clients(&self, all: &[String]) -> String {
        let used = all.iter().enumerate().filter(|(client, _)| self.asks >> client & 1 == 1).map(|(_, name)| name.as_str());
        used.collect::<Vec<_>>().join(", ")
    }
}

/// A token whose life is recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TokenLife {
    /// Number of the token among tokens of its kind.
    pub number: u64,
    /// Column and row of its first pixel, where it has any.
    pub pixel: Option<[u16; 2]>,
    /// Number of pixels of the token.
    pub pixels: usize,
}

/// Transfer on a data bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BusTransfer {
    /// Number of the client.
    pub client: usize,
    /// Posted write rather than read.
    pub write: bool,
}

/// A file that shows a run. It receives only events within the window and the selection of its layout. Events of one unit or one
/// counter arrive in order of time. Events of different units have no order.
pub trait TraceSink {
    /// Returns true if it shows whether tokens are visible.
    fn shows_visible(&self) -> bool {
        false
    }
    /// Receives the state of a unit, with its attribution, from a cycle to the cycle before another.
    fn state(&mut self, stage: usize, state: UnitState, whose: &StepAttribution, from: u64, to: u64);
    /// Receives the value of a [level](CounterList) from a cycle on. The first comes at the beginning of the window.
    fn level(&mut self, level: usize, at: u64, value: CounterValue);
    /// The bus of a [channel](CounterList) moved data of a client, or to it.
    fn moved(&mut self, channel: usize, transfer: BusTransfer, from: u64, to: u64);
    /// A row was open in a bank, both numbered as in [`CounterList`].
    fn open(&mut self, bank: usize, row: u64, from: u64, to: u64);
    /// A frame, by its number from 1 on, took these cycles.
    fn frame(&mut self, number: usize, from: u64, to: u64);
    /// Ends the output; the shown cycles end at `end`. `is_all`: true if the run is complete and its last cycle is shown.
    ///
    /// # Errors
    /// The first error of the writer.
    fn finish(self: Box<Self>, end: u64, is_all: bool) -> io::Result<()>;
}

/// Probe that also receives the attribution of each step and each wait.
pub trait AttributedProbe: Probe {
    /// Receives a busy or stalled interval of a stage. Those of one stage arrive in order of time.
    fn add(&mut self, interval: Interval, whose: &StepAttribution);
}

/// Last value of a counter, and whether the sinks have received it.
#[derive(Clone, Copy, Debug)]
struct CounterNow {
    value: CounterValue,
    told: bool,
    is_shown: bool,
}

/// State of a data bus.
#[derive(Clone, Copy, Debug, Default)]
struct BusNow {
    /// Transfer that may continue.
    open: Option<(BusTransfer, u64, u64)>,
    /// Current interval of the rate, and its busy cycles.
    interval: u64,
    busy: u64,
}

/// Current interval of the hit rate, and its lookups.
#[derive(Clone, Copy, Debug, Default)]
struct HitsNow {
    interval: u64,
    hits: u64,
    all: u64,
}

/// A probe that shows a run to charts.
pub struct TimelineProbe<'a> {
    board: TimelineLayout,
    charts: Vec<Box<dyn TraceSink + 'a>>,
    /// State of each stage that may continue, with its attribution.
    open: Vec<Option<(Interval, StepAttribution)>>,
    numbers: CounterList,
    levels: Vec<CounterNow>,
    buses: Vec<BusNow>,
    hits: Vec<HitsNow>,
}

impl std::fmt::Debug for TimelineProbe<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("TimelineProbe").field("board", &self.board).field("charts", &self.charts.len()).finish_non_exhaustive()
    }
}

impl<'a> TimelineProbe<'a> {
    /// Shows a machine to charts that were made for the same board.
    pub fn new(board: TimelineLayout, charts: Vec<Box<dyn TraceSink + 'a>>) -> Self {
        let numbers = CounterList::new(&board);
        let levels = numbers.all.iter().map(|l| CounterNow { value: l.start, told: false, is_shown: l.is_shown }).collect();
        let (buses, hits) =
            (vec![BusNow::default(); numbers.channels.len()], vec![HitsNow::default(); board.diagram.clients.len()]);
        Self { open: vec![None; board.diagram.stages.len()], board, charts, numbers, levels, buses, hits }
    }

    /// Passes on all open events, cut at the end of the run, and the frames.
    ///
    /// Returns the result of each sink, in order.
    pub fn finish(mut self, run: &RunReport) -> Vec<io::Result<()>> {
        let end = run.total.min(self.board.to);
        let is_all = run.outcome == Outcome::Complete && end == run.total;
        // Events after the end of an incomplete run are not shown.
        self.board.to = end;
        for stage in 0..self.open.len() {
            if let Some((last, whose)) = self.open[stage].take() {
                self.show(last, &whose);
            }
            let done = run.units.get(stage).map_or(0, |unit| unit.account.done);
            self.state(stage, UnitState::Done, &StepAttribution::default(), run.total.saturating_sub(done), run.total);
        }
        for channel in 0..self.buses.len() {
            self.show_transfer(channel, None);
            self.end_rate(channel, end.div_ceil(RATE_CYCLES));
        }
        for client in 0..self.hits.len() {
            self.end_hits(client);
        }
        for level in 0..self.levels.len() {
            self.hold(level, end, None);
        }
        let mut start = 0_u64;
        for (k, &cycles) in run.marks.iter().enumerate() {
            let end = start.saturating_add(cycles);
            if let Some((from, to)) = self.cut(start, end) {
                self.charts.iter_mut().for_each(|chart| chart.frame(k + 1, from, to));
            }
            start = end;
        }
        self.charts.into_iter().map(|chart| chart.finish(end, is_all)).collect()
    }

    /// The part of these cycles that is shown.
    fn cut(&self, from: u64, to: u64) -> Option<(u64, u64)> {
        let (from, to) = (from.max(self.board.from), to.min(self.board.to));
        (from < to).then_some((from, to))
    }

    /// Adds a busy or stalled interval of a stage. Adjacent equal intervals with equal attribution are joined.
    pub fn add(&mut self, new: Interval, whose: &StepAttribution) {
        let Some(open) = self.open.get_mut(new.stage) else { return };
        match open {
            Some((last, of)) if last.cause == new.cause && last.to == new.from && of == whose => last.to = new.to,
            _ => {
                if let Some((last, whose)) = open.replace((new, *whose)) {
                    self.show(last, &whose);
                }
            }
        }
    }

    fn show(&mut self, Interval { stage, cause, from, to }: Interval, whose: &StepAttribution) {
        self.state(stage, cause.map_or(UnitState::Busy, UnitState::Waits), whose, from.0, to.0);
    }

    fn state(&mut self, stage: usize, state: UnitState, whose: &StepAttribution, from: u64, to: u64) {
        if let Some((from, to)) = self.cut(from, to).filter(|_| self.board.shows(stage)) {
            self.charts.iter_mut().for_each(|chart| chart.state(stage, state, whose, from, to));
        }
    }

    /// Sets a counter from cycle `at` on; `None` ends it. The value before is passed on once it is known to hold at the start of the
    /// window.
    fn hold(&mut self, level: usize, at: u64, new: Option<CounterValue>) {
        let TimelineLayout { from, to, .. } = self.board;
        let Some(now) = self.levels.get_mut(level).filter(|now| now.is_shown && new != Some(now.value)) else { return };
        let first = (!now.told && at > from && from < to).then_some((from, now.value));
        let next = new.map(|value| (at, value)).filter(|_| (from + 1..to).contains(&at));
        now.told |= first.is_some();
        now.value = new.unwrap_or(now.value);
        for (at, value) in first.into_iter().chain(next) {
            self.charts.iter_mut().for_each(|chart| chart.level(level, at, value));
        }
    }

    /// Ends the current transfer of a bus, passes it on, and starts the next.
    fn show_transfer(&mut self, channel: usize, next: Option<(BusTransfer, u64, u64)>) {
        let Some((transfer, from, to)) = std::mem::replace(&mut self.buses[channel].open, next) else { return };
        if let Some((from, to)) = self.cut(from, to) {
            self.charts.iter_mut().for_each(|chart| chart.moved(channel, transfer, from, to));
        }
    }

    fn moved(&mut self, channel: usize, transfer: BusTransfer, mut from: u64, to: u64) {
        if !self.numbers.channels[channel].is_shown {
            return;
        }
        match &mut self.buses[channel].open {
            Some((last, _, end)) if *last == transfer && *end == from => *end = to,
            _ => self.show_transfer(channel, Some((transfer, from, to))),
        }
        while from < to {
            let interval = from / RATE_CYCLES;
            self.end_rate(channel, interval);
            let end = to.min((interval + 1) * RATE_CYCLES);
            self.buses[channel].busy += end - from;
            from = end;
        }
    }

    /// Passes on the use of a bus up to interval `next`.
    fn end_rate(&mut self, channel: usize, next: u64) {
        let BusNow { interval, busy, .. } = self.buses[channel];
        if next <= interval {
            return;
        }
        self.hold_rate(channel, interval * RATE_CYCLES, busy);
        if next > interval + 1 {
            self.hold_rate(channel, (interval + 1) * RATE_CYCLES, 0);
        }
        (self.buses[channel].interval, self.buses[channel].busy) = (next, 0);
    }

    fn hold_rate(&mut self, channel: usize, at: u64, busy: u64) {
        let memory = &self.board.diagram.memories[self.numbers.channels[channel].memory];
        let bytes = busy as f64 * f64::from(memory.burst_bytes) / (memory.burst_cycles * RATE_CYCLES) as f64;
        let level = self.numbers.queue(channel);
        self.hold(level + 1, at, Some(CounterValue::Real(bytes)));
        self.hold(level + 2, at, Some(CounterValue::Real(100.0 * busy as f64 / RATE_CYCLES as f64)));
    }

    fn looked_up(&mut self, client: usize, at: u64, found: CacheCounts) {
        if self.hits[client].interval != at / RATE_CYCLES {
            self.end_hits(client);
            self.hits[client].interval = at / RATE_CYCLES;
        }
        let now = &mut self.hits[client];
        now.hits += found.hits;
        now.all += found.hits + found.misses + found.merged;
    }

    /// Passes on the last interval in which a client looked something up.
    fn end_hits(&mut self, client: usize) {
        let HitsNow { interval, hits, all } = std::mem::take(&mut self.hits[client]);
        if all > 0 {
            let percent = 100.0 * hits as f64 / all as f64;
            self.hold(self.numbers.hit_rate(client), interval * RATE_CYCLES, Some(CounterValue::Real(percent)));
        }
    }
}

impl AttributedProbe for TimelineProbe<'_> {
    fn add(&mut self, interval: Interval, whose: &StepAttribution) {
        TimelineProbe::add(self, interval, whose);
    }
}

impl Probe for TimelineProbe<'_> {
    fn reads_visible(&self) -> bool {
        self.charts.iter().any(|chart| chart.shows_visible())
    }

    fn on_busy(&mut self, stage: usize, from: Cycle, to: Cycle) {
        self.add(Interval { stage, cause: None, from, to }, &StepAttribution::default());
    }

    fn on_stall(&mut self, stage: usize, cause: StallCause, from: Cycle, to: Cycle) {
        self.add(Interval { stage, cause: Some(cause), from, to }, &StepAttribution::default());
    }

    fn on_occupancy(&mut self, fifo: usize, at: Cycle, slots: usize) {
        self.hold(fifo, at.0, Some(CounterValue::Count(slots as u64)));
    }

    fn on_visible_count(&mut self, fifo: usize, at: Cycle, tokens: usize) {
        self.hold(self.numbers.valid(fifo), at.0, Some(CounterValue::Count(u64::from(tokens > 0))));
    }

    fn on_memory_event(&mut self, event: MemoryEvent) {
        match event {
            MemoryEvent::Moved { memory, channel, client, write, from, to } => {
                self.moved(self.numbers.channel(memory, channel), BusTransfer { client, write }, from.0, to.0);
            }
            MemoryEvent::Open { memory, channel, bank, row, from, to } => {
                let ChannelCounters { first_bank, is_shown, .. } = self.numbers.channels[self.numbers.channel(memory, channel)];
                if let Some((from, to)) = self.cut(from.0, to.0).filter(|_| is_shown) {
                    self.charts.iter_mut().for_each(|chart| chart.open(first_bank + bank, row, from, to));
                }
            }
            MemoryEvent::Queued { memory, channel, at, bursts } => {
                let level = self.numbers.queue(self.numbers.channel(memory, channel));
                self.hold(level, at.0, Some(CounterValue::Count(bursts as u64)));
            }
            MemoryEvent::InFlight { client, at, requests } => {
                let credits = self.board.diagram.clients[client].credits.saturating_sub(requests as u64);
                self.hold(self.numbers.credits(client), at.0, Some(CounterValue::Count(credits)));
            }
            MemoryEvent::LookedUp { client, at, found } => self.looked_up(client, at.0, found),
        }
    }
}
