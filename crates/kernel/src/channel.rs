//! One channel of a memory (law 4): its queue, its banks with open rows, and its bus.
//!
//! No clock runs here. The next burst to serve is the one in view whose column command can be issued first, and these times
//! follow from the bursts served before. So the next choice, and its cycle, can be computed as soon as the set of bursts in view
//! is known. A choice is *final* if no later event can change it:
//!
//! - A burst of a request that arrives in cycle h or later comes into view at h + 1 or later, and is served there at the earliest. So a
//!   choice with a column command at h + 1 or before is final (at h + 1 it is the older of equals).
//! - While the window is full, no other burst comes into view before the choice is served.
//! - Once the oldest burst has been passed over `cap` times, it is next in any case.

use crate::burst::Burst;
use crate::counts::{ChannelCounts, RowOutcome};
use crate::memory_events::{ChannelEvents, EventBounds, MemoryEvent, closed_at};
use crate::{Cycle, MemoryConfig};
use command_bus::CommandBus;
use timing::{Bank, CLOSED, ChannelTiming, ColumnCommand};

/// A burst in the queue.
#[derive(Clone, Copy, Debug)]
struct QueuedBurst {
    burst: Burst,
    /// First cycle in view. For a burst behind the window: the first cycle in view if there were room.
    from: Cycle,
}

/// A served burst.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ServedBurst {
    pub(crate) burst: Burst,
    pub(crate) row: RowOutcome,
    /// Cycle of its column command.
    pub(crate) column: Cycle,
    /// The cycle after its last data.
    pub(crate) end: Cycle,
}

/// One channel.
#[derive(Clone, Debug)]
pub(crate) struct Channel {
    timing: ChannelTiming,
    window: usize,
    cap: u64,
    /// Unserved bursts, oldest first, from `first` on. The first `window` of them are in view. (Served bursts stay in front and
    /// are cleared from time to time. So serving the oldest burst, or one near it, moves no others, and all lie in one piece of
    /// memory. A separate queue for bursts behind the window cost more, because each burst was inserted twice.)
    queue: Vec<QueuedBurst>,
    first: usize,
    /// Number of times that the oldest burst has been passed over.
    passed: u64,
    banks: Box<[Bank]>,
    /// Earliest next column command, by direction; and the earlier of the two.
    next: [Cycle; 2],
    soonest: Cycle,
    /// Direction of the last column command: 0 read, 1 write, 2 none yet.
    last: usize,
    /// Earliest next activation. `four`: for each of the last four activations, the earliest cycle of the fourth activation after
    /// it.
    activation: Cycle,
    four: [Cycle; 4],
    activations: usize,
    commands: CommandBus,
    /// Number of column commands, and the cycles of the last of them: at least as many as can come into view together.
    served: usize,
    columns: Box<[Cycle]>,
    /// The next choice and its place in the queue, if it was computed before it was final.
    choice: Option<(usize, ColumnCommand)>,
    /// All counts that do not follow from other fields.
    counts: ChannelCounts,
    /// Number of bursts of periodic clients in the queue.
    pub(crate) periodic: u64,
    /// Cycles after the end of the run in which it moves data for periodic clients.
    pub(crate) overrun: u64,
    /// Events for a probe, if one is attached.
    pub(crate) watch: Option<Box<ChannelEvents>>,
}

impl Channel {
    pub(crate) fn new(config: &MemoryConfig) -> Self {
        let timing = ChannelTiming::new(config);
        let until = if timing.refi == 0 { Cycle::UNKNOWN } else { Cycle(timing.refi) };
        let bank = Bank { row: CLOSED, ready: Cycle::ZERO, free: Cycle::ZERO, until };
        let window = config.window.max(1) as usize;
        Self {
            timing,
            window,
            cap: config.cap.into(),
            queue: Vec::with_capacity(4 * window),
            first: 0,
            passed: 0,
            banks: vec![bank; config.banks.max(1) as usize].into(),
            next: [Cycle::ZERO; 2],
            soonest: Cycle::ZERO,
            last: 2,
            activation: Cycle::ZERO,
            four: [Cycle::ZERO; 4],
            activations: 0,
            commands: CommandBus::new(config.commands_per_cycle, window),
            served: 0,
            columns: vec![Cycle::ZERO; window.next_power_of_two()].into(),
            choice: None,
            counts: ChannelCounts::default(),
            periodic: 0,
            overrun: 0,
            watch: None,
        }
    }

    /// Records events from now on.
    pub(crate) fn keep_events(&mut self) {
        self.watch = Some(Box::new(ChannelEvents::new(self.banks.len())));
    }

    /// See [`ChannelEvents::emit`].
    pub(crate) fn emit(&mut self, place: [usize; 2], settled: Cycle, bounds: EventBounds, emit: impl FnMut(MemoryEvent)) {
        if let Some(watch) = &mut self.watch {
            let open = self.banks.iter().enumerate().filter(|(_, bank)| bank.row != CLOSED);
            watch.emit(place, open.map(|(number, bank)| (number, bank.row, bank.until)), settled, bounds, emit);
        }
    }

    /// Returns the number of banks.
    pub(crate) fn banks(&self) -> usize {
        self.banks.len()
    }

    /// Appends a burst. Bursts must come in order of (arrival, port number, order of issue, address).
    #[inline(always)]
    pub(crate) fn push(&mut self, burst: Burst) {
        let place = self.queue.len() - self.first;
        if self.queue.len() == self.queue.capacity() {
            self.clear_away();
        }
        let mut new = QueuedBurst { burst, from: burst.arrival + 1 };
        if place < self.window {
            new.from = new.from.max(self.room_made(place));
            if self.choice.is_some() {
                self.reconsider(place, &new);
            }
        }
        self.queue.push(new);
    }

    /// Frees space if at least half of the queue is served; otherwise the queue grows. So bursts are moved rarely.
    #[cold]
    fn clear_away(&mut self) {
        if 2 * self.first >= self.queue.len() {
            self.queue.drain(..self.first);
            self.first = 0;
        }
    }

    /// Returns the cycle after the column command that made room for a burst with `place` others ahead of it. It may be later
    /// than the arrival of the burst, because choices can be final early.
    #[inline]
    fn room_made(&self, place: usize) -> Cycle {
        match (self.served + place).checked_sub(self.window) {
            Some(made_room) => self.columns[made_room & (self.columns.len() - 1)] + 1,
            None => Cycle::ZERO,
        }
    }

    /// Updates the choice if a burst comes into view after the choice was made.
    fn reconsider(&mut self, place: usize, new: &QueuedBurst) {
        if let Some((_, best)) = self.choice.filter(|(_, best)| self.passed < self.cap && best.at > new.from.max(self.soonest)) {
            let column = self.column(new, self.bank(new));
            if column.at < best.at {
                self.choice = Some((place, column));
            }
        }
    }

    #[inline(always)]
    fn bank(&self, waiting: &QueuedBurst) -> &Bank {
        &self.banks[waiting.burst.bank as usize]
    }

    /// Returns the time of a burst's column command, assuming that it is the next.
    #[inline(always)]
    fn column(&self, QueuedBurst { burst, from }: &QueuedBurst, bank: &Bank) -> ColumnCommand {
        let bus = self.next[usize::from(burst.write)].max(*from);
        let column = self.column_in(bank, burst.row, *from, bus);
        if column.at < bank.until { column } else { self.column_refreshed(column.at, burst.row, *from, bus) }
    }

    /// As `column`, if a refresh comes first or has come since the last use of the bank.
    #[cold]
    fn column_refreshed(&self, mut at: Cycle, row: u64, from: Cycle, bus: Cycle) -> ColumnCommand {
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
    fn column_in(&self, bank: &Bank, row: u64, from: Cycle, bus: Cycle) -> ColumnCommand {
        let until = bank.until;
        if bank.row == row {
            return ColumnCommand { at: bus.max(bank.ready), row: RowOutcome::Hit, activation: Cycle::ZERO, until };
        }
        let free = bank.free.max(from);
        let (row, free) =
            if bank.row == CLOSED { (RowOutcome::Closed, free) } else { (RowOutcome::Conflict, free + self.timing.rp) };
        let mut activation = free.max(self.activation);
        if self.commands.is_limited() {
            activation = self.activation_on_bus(activation, row);
        }
        ColumnCommand { at: bus.max(activation + self.timing.rcd), row, activation, until }
    }

    /// Returns the first activation from `from` on that the command bus can carry, with a precharge if another row is open. No row
    /// command precedes the column command that made room in the window for the next burst.
    #[inline]
    fn activation_on_bus(&self, from: Cycle, row: RowOutcome) -> Cycle {
        let precharge = (row == RowOutcome::Conflict).then_some(self.timing.rp);
        let earliest = self.room_made(0) + precharge.unwrap_or(0);
        self.commands.activation(from.max(earliest), precharge)
    }

    /// Chooses by first ready, first come. Among bursts of one bank and direction with equal row state, only the oldest can be
    /// first: all other conditions are equal, and views only grow.
    #[inline(always)]
    fn first_ready(&self) -> Option<(usize, ColumnCommand)> {
        let (oldest, others) = self.queue[self.first..].split_first()?;
        let bank = self.bank(oldest);
        let column = self.column(oldest, bank);
        // No command can be issued before `soonest`. Usually the oldest burst finds its row open and is served then.
        if column.at <= self.soonest || self.passed >= self.cap {
            return Some((0, column));
        }
        let mut best = (0, column);
        let mut asked = class(oldest, bank);
        for (place, candidate) in (1..self.window).zip(others) {
            // Neither this burst nor any behind it can be served before it is in view.
            if best.1.at <= candidate.from {
                break;
            }
            let bank = self.bank(candidate);
            let class = class(candidate, bank);
            if asked & class != 0 {
                continue;
            }
            asked |= class;
            let column = self.column(candidate, bank);
            if column.at < best.1.at {
                best = (place, column);
                if column.at <= self.soonest {
                    break;
                }
            }
        }
        Some(best)
    }

    /// Returns true if a burst of a unit waits.
    #[inline]
    pub(crate) fn has_units(&self) -> bool {
        (self.queue.len() - self.first) as u64 > self.periodic
    }

    /// Returns the column command of the next choice, as far as the bursts in view are known; `None` if no burst waits.
    pub(crate) fn next_column(&mut self) -> Option<Cycle> {
        if self.choice.is_none() {
            self.choice = self.first_ready();
        }
        self.choice.map(|(_, column)| column.at)
    }

    /// Serves the next choice if it is final, given that all later requests arrive at `horizon` or later.
    #[inline(always)]
    pub(crate) fn serve(&mut self, horizon: Cycle) -> Option<ServedBurst> {
        let (place, column) = match self.choice {
            Some(choice) => choice,
            None => self.first_ready()?,
        };
        if column.at > horizon + 1 && self.queue.len() - self.first < self.window && self.passed < self.cap {
            self.choice = Some((place, column));
            return None;
        }
        self.choice = None;
        let burst = self.take(place, column.at);
        self.columns[self.served & (self.columns.len() - 1)] = column.at;
        self.served += 1;
        self.command(&burst, &column);
        let data = self.timing.data[usize::from(burst.write)];
        Some(ServedBurst { burst, row: column.row, column: column.at, end: column.at + data })
    }

    /// Removes a burst from the queue. Its column command is issued at `at`, and the next burst comes into view after that.
    #[inline(always)]
    fn take(&mut self, place: usize, at: Cycle) -> Burst {
        let chosen = self.first + place;
        let QueuedBurst { burst, .. } = self.queue[chosen];
        self.passed = if place == 0 { 0 } else { self.passed + 1 };
        if place > 0 {
            self.queue.copy_within(self.first..chosen, self.first + 1);
        }
        self.first += 1;
        if let Some(next) = self.queue.get_mut(self.first + self.window - 1) {
            next.from = next.from.max(at + 1);
        }
        burst
    }

    /// Applies the commands of a burst to the state of its bank and channel.
    #[inline(always)]
    fn command(&mut self, burst: &Burst, column: &ColumnCommand) {
        let (timing, direction) = (&self.timing, usize::from(burst.write));
        let bank = &mut self.banks[burst.bank as usize];
        if column.row != RowOutcome::Hit {
            let at = column.activation;
            if let Some(watch) = &mut self.watch {
                let before = Some(bank.row).filter(|row| *row != CLOSED);
                watch.open(burst.bank as usize, before, closed_at(column.row, at, timing.rp, bank.until), at);
            }
            (bank.row, bank.ready, bank.free) = (burst.row, at + timing.rcd, at + timing.ras);
            self.four[self.activations % 4] = at + timing.faw;
            self.activations += 1;
            self.activation = self.four[self.activations % 4].max(at + timing.rrd);
        }
        if self.commands.is_limited() {
            let rp = (column.row == RowOutcome::Conflict).then_some(timing.rp);
            let activation = (column.row != RowOutcome::Hit).then_some(column.activation);
            let precharge = rp.map(|rp| Cycle(column.activation.0 - rp));
            self.commands.issue(precharge.into_iter().chain(activation), column.at);
        }
        bank.until = column.until;
        bank.free = bank.free.max(column.at + timing.recovery[direction]);
        self.next = timing.gaps[direction].map(|gap| column.at + gap);
        self.soonest = self.next[0].min(self.next[1]);
        let counts = &mut self.counts;
        counts.turn_arounds += u64::from(self.last ^ 1 == direction);
        self.last = direction;
        counts.rows.count(column.row);
        counts.queued += column.at.since(burst.arrival);
    }

    /// Returns the cycles from the first row command of a burst to its column command.
    pub(crate) fn row_cycles(&self, row: RowOutcome) -> u64 {
        match row {
            RowOutcome::Hit => 0,
            RowOutcome::Closed => self.timing.rcd,
            RowOutcome::Conflict => self.timing.rp + self.timing.rcd,
        }
    }

    /// Returns the counts of a run of `total` cycles.
    pub(crate) fn counts(&self, total: u64) -> ChannelCounts {
        let bus_busy = self.counts.rows.bursts() * self.timing.burst_cycles - self.overrun;
        let waiting = self.queue[self.first..].iter().map(|waiting| Cycle(total).since(waiting.burst.arrival));
        let queued = self.counts.queued + waiting.sum::<u64>();
        let refreshes = total.saturating_sub(1).checked_div(self.timing.refi).unwrap_or(0);
        ChannelCounts { bus_busy, queued, refreshes, ..self.counts }
    }
}

/// Returns one bit for the burst's bank, its direction and its row state; 0 if there are too many banks.
#[inline(always)]
fn class(QueuedBurst { burst, .. }: &QueuedBurst, bank: &Bank) -> u64 {
    let is_open = bank.row == burst.row;
    1_u64.unbounded_shl(burst.bank * 4 + u32::from(burst.write) * 2 + u32::from(is_open))
}

mod command_bus;
mod run;
#[cfg(test)]
mod tests;
mod timing;
