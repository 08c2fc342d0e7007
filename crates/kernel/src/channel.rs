//! One channel of a memory (law 4): its queue, its banks of open rows, its bus.
//!
//! No clock runs here. Of the bursts in view the one whose column command can go first is served next, and when each could go
//! follows from what was served before; so the next choice, and its cycle, can be computed as soon as it is known what can be
//! in view. A choice is *final* when nothing that is still to come could change it:
//!
//! - a burst of a request that arrives in cycle h or later comes into view at h + 1 or later, and goes there at the earliest:
//!   so a choice with a column command at h + 1 or before stands (at h + 1 it is the older of equals);
//! - while the window is full nothing else comes into view before the choice is served;
//! - once the oldest has been passed over `cap` times it is next, whatever comes.

use crate::counts::{ChannelCounts, Row};
use crate::{Cycle, MemoryConfig};
use std::collections::VecDeque;

/// A burst that waits for its column command.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Burst {
    pub(crate) bank: u32,
    pub(crate) row: u64,
    pub(crate) write: bool,
    /// When its request arrived.
    pub(crate) arrival: Cycle,
    /// Client and number of its request.
    pub(crate) client: u32,
    pub(crate) request: u64,
}

/// A burst in view.
#[derive(Clone, Copy, Debug)]
struct InView {
    burst: Burst,
    /// Since when.
    from: Cycle,
    /// A bit for its bank and direction, with a free one beside it; none where there are too many banks.
    class: u64,
}

impl InView {
    #[inline]
    fn new(burst: Burst, from: Cycle) -> Self {
        let class = if burst.bank < 16 { 1 << (burst.bank * 4 + u32::from(burst.write) * 2) } else { 0 };
        Self { burst, from, class }
    }
}

/// Row of a closed bank: more than any row can be, as rows have 4 bytes and more.
const CLOSED: u64 = u64::MAX;

/// One bank.
#[derive(Clone, Copy, Debug)]
struct Bank {
    row: u64,
    /// The first column command since its activation.
    ready: Cycle,
    /// It may be precharged or, closed, activated.
    free: Cycle,
    /// The next refresh, which closes it.
    until: Cycle,
}

/// When the column command of a burst can go, were it the next, and what goes before it.
#[derive(Clone, Copy, Debug)]
struct Column {
    at: Cycle,
    row: Row,
    activation: Cycle,
    /// The refresh after it.
    until: Cycle,
}

/// The times of a channel that follow from its parameters, by direction where there are two: read, write.
#[derive(Clone, Copy, Debug)]
struct Timing {
    /// From a column command in one direction to the next, in each.
    gaps: [[u64; 2]; 2],
    /// From column command to the end of its data.
    data: [u64; 2],
    /// From column command to precharge.
    recovery: [u64; 2],
    rcd: u64,
    rp: u64,
    ras: u64,
    rrd: u64,
    faw: u64,
    refi: u64,
    rfc: u64,
    burst_cycles: u64,
}

impl Timing {
    fn new(c: &MemoryConfig) -> Self {
        let [cl, cwl, burst] = [c.cl, c.cwl, c.burst_cycles].map(u64::from);
        let read_to_write = burst.max((cl + burst + 1).saturating_sub(cwl));
        let write_to_read = cwl + burst + u64::from(c.wtr);
        Self {
            gaps: [[burst, read_to_write], [write_to_read, burst]],
            data: [cl + burst, cwl + burst],
            recovery: [c.rtp.into(), cwl + burst + u64::from(c.wr)],
            rcd: c.rcd.into(),
            rp: c.rp.into(),
            ras: c.ras.into(),
            rrd: c.rrd.into(),
            faw: c.faw.into(),
            refi: c.refi.into(),
            rfc: c.rfc.into(),
            burst_cycles: burst,
        }
    }

    /// A bank after the last refresh up to cycle `at`.
    #[cold]
    fn refreshed(&self, at: Cycle) -> Bank {
        let last = Cycle(at.0 / self.refi * self.refi);
        Bank { row: CLOSED, ready: Cycle::ZERO, free: last + self.rfc, until: last + self.refi }
    }
}

/// One channel.
#[derive(Clone, Debug)]
pub(crate) struct Channel {
    timing: Timing,
    window: usize,
    cap: u64,
    /// The first of those not served, oldest first, from `first` on. (What was served is left in front, and cleared away now and
    /// then: neither the oldest nor one near it moves the others, and they lie in one piece.)
    queue: Vec<InView>,
    first: usize,
    /// Those behind the window.
    behind: VecDeque<Burst>,
    /// How often the oldest has been passed over.
    passed: u64,
    banks: Box<[Bank]>,
    /// The next column command may go, by direction.
    next: [Cycle; 2],
    /// Whether the last one was a write; none before the first.
    last: Option<bool>,
    /// The next activation may go: after the last one, and after each of the last four.
    activation: Cycle,
    four: [Cycle; 4],
    activations: usize,
    /// Column commands so far, and the cycles of the last of them, at least as many as come into view together.
    served: usize,
    columns: Box<[Cycle]>,
    /// The next choice and its place in the queue, once asked for.
    choice: Option<(usize, Column)>,
    /// All but what follows from the rest.
    counts: ChannelCounts,
}

impl Channel {
    pub(crate) fn new(config: &MemoryConfig) -> Self {
        let timing = Timing::new(config);
        let until = if timing.refi == 0 { Cycle::UNKNOWN } else { Cycle(timing.refi) };
        let bank = Bank { row: CLOSED, ready: Cycle::ZERO, free: Cycle::ZERO, until };
        let window = config.window.max(1) as usize;
        Self {
            timing,
            window,
            cap: config.cap.into(),
            queue: Vec::with_capacity(4 * window),
            first: 0,
            behind: VecDeque::new(),
            passed: 0,
            banks: vec![bank; config.banks.max(1) as usize].into(),
            next: [Cycle::ZERO; 2],
            last: None,
            activation: Cycle::ZERO,
            four: [Cycle::ZERO; 4],
            activations: 0,
            served: 0,
            columns: vec![Cycle::ZERO; window.next_power_of_two()].into(),
            choice: None,
            counts: ChannelCounts::default(),
        }
    }

    /// Takes in a burst; to be called in order of (arrival, port number, issue, address).
    #[inline]
    pub(crate) fn push(&mut self, burst: Burst) {
        let place = self.in_view().len();
        if place == self.window {
            return self.behind.push_back(burst);
        }
        let new = InView::new(burst, self.view(burst.arrival, place));
        self.come_into_view(new);
        if let Some((_, best)) = self.choice.filter(|(_, best)| self.passed < self.cap && best.at > self.soonest(&new)) {
            let column = self.column(&new);
            if column.at < best.at {
                self.choice = Some((place, column));
            }
        }
    }

    #[inline]
    fn in_view(&self) -> &[InView] {
        &self.queue[self.first..]
    }

    #[inline]
    fn come_into_view(&mut self, burst: InView) {
        if self.queue.len() == self.queue.capacity() {
            self.queue.drain(..self.first);
            self.first = 0;
        }
        self.queue.push(burst);
    }

    /// When a burst with `place` others ahead of it comes into view: after its arrival, and after the column command that made
    /// the room, which may be later where it was final so early.
    #[inline]
    fn view(&self, arrival: Cycle, place: usize) -> Cycle {
        let arrived = arrival + 1;
        match (self.served + place).checked_sub(self.window) {
            Some(made_room) => arrived.max(self.columns[made_room & (self.columns.len() - 1)] + 1),
            None => arrived,
        }
    }

    /// When the column command of a burst can go, were it the next.
    #[inline]
    fn column(&self, InView { burst, from, .. }: &InView) -> Column {
        let bus = self.next[usize::from(burst.write)].max(*from);
        let bank = &self.banks[burst.bank as usize];
        let column = self.column_in(bank, burst.row, *from, bus);
        if column.at < bank.until { column } else { self.column_refreshed(column.at, burst.row, *from, bus) }
    }

    /// The same where a refresh comes first, or has come since the bank was last used.
    #[cold]
    fn column_refreshed(&self, mut at: Cycle, row: u64, from: Cycle, bus: Cycle) -> Column {
        loop {
            let bank = self.timing.refreshed(at);
            let column = self.column_in(&bank, row, from, bus);
            if column.at < bank.until {
                return column;
            }
            at = column.at;
        }
    }

    #[inline(always)]
    fn column_in(&self, bank: &Bank, row: u64, from: Cycle, bus: Cycle) -> Column {
        let until = bank.until;
        if bank.row == row {
            return Column { at: bus.max(bank.ready), row: Row::Hit, activation: Cycle::ZERO, until };
        }
        let free = bank.free.max(from);
        let (row, free) = if bank.row == CLOSED { (Row::Closed, free) } else { (Row::Conflict, free + self.timing.rp) };
        let activation = free.max(self.activation).max(self.four[self.activations % 4]);
        Column { at: bus.max(activation + self.timing.rcd), row, activation, until }
    }

    /// The next choice, as far as it is known what is in view; none where nothing waits.
    #[inline]
    fn choose(&mut self) -> Option<(usize, Column)> {
        if self.choice.is_none() {
            self.choice = self.first_ready();
        }
        self.choice
    }

    /// First ready, first come. Of bursts of one bank and direction that find their rows open, or do not, only the oldest can be
    /// first: the rest is the same for all, and views only grow.
    fn first_ready(&self) -> Option<(usize, Column)> {
        let (oldest, others) = self.in_view().split_first()?;
        let mut best = (0, self.column(oldest));
        if self.passed >= self.cap {
            return Some(best);
        }
        let mut asked = self.class(oldest);
        for (place, candidate) in (1..).zip(others) {
            if best.1.at <= self.soonest(candidate) {
                break;
            }
            let class = self.class(candidate);
            if asked & class != 0 {
                continue;
            }
            asked |= class;
            let column = self.column(candidate);
            if column.at < best.1.at {
                best = (place, column);
            }
        }
        Some(best)
    }

    /// Neither it nor any behind it can go before: column commands keep their distance, and views only grow.
    #[inline(always)]
    fn soonest(&self, candidate: &InView) -> Cycle {
        candidate.from.max(self.next[0].min(self.next[1]))
    }

    /// A bit for its bank, its direction, and whether its row is open.
    #[inline(always)]
    fn class(&self, InView { burst, class, .. }: &InView) -> u64 {
        class << u32::from(self.banks[burst.bank as usize].row == burst.row)
    }

    /// The column command of the next choice; none where nothing waits.
    pub(crate) fn next_column(&mut self) -> Option<Cycle> {
        self.choose().map(|(_, column)| column.at)
    }

    /// Serves the next choice if it is final when every request that is still to come arrives at `horizon` or later: its burst,
    /// the cycle of its column command, and the cycle after its last data.
    #[inline(always)]
    pub(crate) fn serve(&mut self, horizon: Cycle) -> Option<(Burst, Row, Cycle, Cycle)> {
        let (place, column) = self.choose()?;
        let is_full = self.in_view().len() == self.window;
        if column.at > horizon + 1 && !is_full && self.passed < self.cap {
            return None;
        }
        let InView { burst, .. } = self.queue[self.first + place];
        self.queue.copy_within(self.first..self.first + place, self.first + 1);
        self.first += 1;
        if let Some(next) = self.behind.pop_front() {
            self.come_into_view(InView::new(next, next.arrival.max(column.at) + 1));
        }
        self.choice = None;
        self.passed = if place == 0 { 0 } else { self.passed + 1 };
        self.columns[self.served & (self.columns.len() - 1)] = column.at;
        self.served += 1;
        self.command(&burst, &column);
        Some((burst, column.row, column.at, column.at + self.timing.data[usize::from(burst.write)]))
    }

    /// Gives the commands of a burst: what they leave behind.
    #[inline]
    fn command(&mut self, burst: &Burst, column: &Column) {
        let (timing, direction) = (&self.timing, usize::from(burst.write));
        let bank = &mut self.banks[burst.bank as usize];
        if column.row != Row::Hit {
            let at = column.activation;
            (bank.row, bank.ready, bank.free) = (burst.row, at + timing.rcd, at + timing.ras);
            self.activation = at + timing.rrd;
            self.four[self.activations % 4] = at + timing.faw;
            self.activations += 1;
        }
        bank.until = column.until;
        bank.free = bank.free.max(column.at + timing.recovery[direction]);
        self.next = timing.gaps[direction].map(|gap| column.at + gap);
        let counts = &mut self.counts;
        counts.turn_arounds += u64::from(self.last == Some(!burst.write));
        self.last = Some(burst.write);
        counts.rows.count(column.row);
        counts.queued += column.at.since(burst.arrival);
    }

    /// What it moved in a run of `total` cycles.
    pub(crate) fn counts(&self, total: u64) -> ChannelCounts {
        let bus_busy = self.counts.rows.bursts() * self.timing.burst_cycles;
        let refreshes = total.saturating_sub(1).checked_div(self.timing.refi).unwrap_or(0);
        ChannelCounts { bus_busy, refreshes, ..self.counts }
    }
}

#[cfg(test)]
mod tests;
