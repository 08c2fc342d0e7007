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

/// A burst in the queue.
#[derive(Clone, Copy, Debug)]
struct Queued {
    burst: Burst,
    /// When it comes into view; unknown while `window` others are ahead of it.
    view: Cycle,
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
    queue: VecDeque<Queued>,
    /// How often the oldest has been passed over.
    passed: u64,
    banks: Box<[Bank]>,
    /// The next column command may go, by direction.
    next: [Cycle; 2],
    last_was_write: bool,
    /// The next activation may go: after the last one, and after each of the last four.
    activation: Cycle,
    four: [Cycle; 4],
    activations: usize,
    /// Column commands so far, and the cycles of the last of them, at least as many as come into view together.
    served: usize,
    columns: Box<[Cycle]>,
    /// The next choice and its place in the queue, once asked for.
    choice: Option<(usize, Column)>,
    pub(crate) counts: ChannelCounts,
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
            queue: VecDeque::new(),
            passed: 0,
            banks: vec![bank; config.banks.max(1) as usize].into(),
            next: [Cycle::ZERO; 2],
            last_was_write: false,
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
        let place = self.queue.len();
        let view = if place < self.window { self.view(burst.arrival, place) } else { Cycle::UNKNOWN };
        self.queue.push_back(Queued { burst, view });
        if place >= self.window || (place > 0 && self.passed >= self.cap) {
            return;
        }
        if let Some((_, best)) = self.choice {
            let column = self.column(&self.queue[place]);
            if column.at < best.at {
                self.choice = Some((place, column));
            }
        }
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

    /// When the column command of `queued` can go, were it the next.
    #[inline]
    fn column(&self, queued: &Queued) -> Column {
        let bus = queued.view.max(self.next[usize::from(queued.burst.write)]);
        let mut bank = self.banks[queued.burst.bank as usize];
        loop {
            let column = self.column_in(bank, queued, bus);
            if column.at < bank.until {
                return column;
            }
            bank = self.timing.refreshed(column.at);
        }
    }

    #[inline]
    fn column_in(&self, bank: Bank, queued: &Queued, bus: Cycle) -> Column {
        let until = bank.until;
        if bank.row == queued.burst.row {
            return Column { at: bus.max(bank.ready), row: Row::Hit, activation: Cycle::ZERO, until };
        }
        let free = bank.free.max(queued.view);
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

    /// First ready, first come.
    fn first_ready(&self) -> Option<(usize, Column)> {
        let mut best = (0, self.column(self.queue.front()?));
        if self.passed >= self.cap {
            return Some(best);
        }
        let soonest = self.next[0].min(self.next[1]);
        for (place, queued) in self.queue.iter().enumerate().take(self.window).skip(1) {
            // Nothing from here on can go before: views only grow, and column commands keep their distance.
            if best.1.at <= queued.view.max(soonest) {
                break;
            }
            let column = self.column(queued);
            if column.at < best.1.at {
                best = (place, column);
            }
        }
        Some(best)
    }

    /// The column command of the next choice; none where nothing waits.
    pub(crate) fn next_column(&mut self) -> Option<Cycle> {
        self.choose().map(|(_, column)| column.at)
    }

    /// Serves the next choice if it is final when every request that is still to come arrives at `horizon` or later: its burst,
    /// the cycle of its column command, and the cycle after its last data.
    #[inline]
    pub(crate) fn serve(&mut self, horizon: Cycle) -> Option<(Burst, Row, Cycle, Cycle)> {
        let (place, column) = self.choose()?;
        let is_final = column.at <= horizon + 1 || self.queue.len() >= self.window || self.passed >= self.cap;
        if !is_final {
            return None;
        }
        let Queued { burst, .. } = self.queue.remove(place)?;
        self.choice = None;
        self.passed = if place == 0 { 0 } else { self.passed + 1 };
        self.columns[self.served & (self.columns.len() - 1)] = column.at;
        self.served += 1;
        if let Some(next) = self.queue.get_mut(self.window - 1) {
            next.view = next.burst.arrival.max(column.at) + 1;
        }
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
        counts.turn_arounds += u64::from(counts.bus_busy > 0 && self.last_was_write != burst.write);
        self.last_was_write = burst.write;
        counts.rows.count(column.row);
        counts.bus_busy += timing.burst_cycles;
        counts.queued += column.at.since(burst.arrival);
    }

    /// Refreshes in a run of `total` cycles.
    pub(crate) fn refreshes(&self, total: u64) -> u64 {
        total.saturating_sub(1).checked_div(self.timing.refi).unwrap_or(0)
    }
}

#[cfg(test)]
mod tests;
