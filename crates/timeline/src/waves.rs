//! A time line as waves, a file in GTKWave's format FST for GTKWave and Surfer.
//!
//! | scope | signals |
//! |---|---|
//! | the machine | `frame`, the number of the frame, 0 behind the last |
//! | a unit, with its numeral | `busy`, `starved`, `blocked`, `memory`, `done`: one of them is 1 |
//! | a FIFO | `fill`, the slots that it holds; `ready`, one is free; `valid`, one is held, and the unit that takes from it is not seen to wait for it |
//! | a channel of a memory | `queue`, `bytes_per_cycle`, `bus_use`; `bus`, it moves data; `client` and `write`, whose and whether to the memory |
//! | a bank in it | `open`, and its `row` |
//! | a client | `credits`, those that it has left |
//! | a cache | `hit_rate` |
//!
//! States are wires, a bit each: FST has named states, but the library that writes it does not, and a number would have to be looked
//! up. `valid` is derived: the probe is not told when a token becomes visible, but a unit that starves shows that none is.
//!
//! FST is written in order of time, and the probe is told of one unit far ahead of another. So [`Waves`] keeps all changes, in some
//! three bytes each and within a budget, and writes when the run is over. A file of its own to sort them in was rejected: it would
//! need a file system here, and what does not fit is no file that anybody would look through, but one for `--from-cycle`.

use crate::board::Board;
use crate::levels::Value;
use crate::scale::Scale;
use crate::streams::Streams;
use crate::watcher::{Chart, State, Transfer, Whose};
use crate::wires::{BUSY, DONE, FIRST_WAIT, FRAME, Numbers, Signals};
use basrelief_input::Budget;
use basrelief_kernel::Cause;
use fst_writer::{FstFileType, FstHeaderWriter, FstInfo, FstWriteError};
use std::io::{self, Seek, Write};

/// Bytes of changes that are written at once.
const SECTION: usize = 1 << 22;

/// Writes waves when the run is over.
#[derive(Debug)]
pub struct Waves<W> {
    out: W,
    board: Board,
    numbers: Numbers,
    changes: Streams,
    /// When the last state of each stage, bus and bank ends, by the number of its value.
    ends: Vec<u64>,
    pub(crate) section: usize,
}

impl<W: Write + Seek> Waves<W> {
    /// Nothing yet; what is kept counts towards the budget.
    pub fn new(out: W, board: &Board, budget: &Budget) -> Self {
        let numbers = Numbers::new(board);
        let changes = Streams::new(numbers.count, budget);
        Self { out, board: board.clone(), changes, ends: vec![board.from; numbers.count], numbers, section: SECTION }
    }

    /// A value holds from one cycle to the one before another, and is 0 where none is said to.
    fn hold(&mut self, number: usize, value: u64, from: u64, to: u64) {
        if from > self.ends[number] {
            self.changes.change(number, self.ends[number], 0);
        }
        self.changes.change(number, from, value);
        self.ends[number] = to;
    }

    fn write(self, end: u64) -> Result<(), FstWriteError> {
        let Self { mut out, board, numbers, changes, section, .. } = self;
        // The library would panic.
        out.stream_position().map_err(|e| io::Error::new(e.kind(), format!("FST needs a file, no pipe: {e}")))?;
        let (scale, timescale_exponent) = Scale::whole(board.hz);
        let info = FstInfo {
            start_time: 0,
            timescale_exponent,
            version: concat!("basrelief ", env!("CARGO_PKG_VERSION")).into(),
            date: String::new(),
            file_type: FstFileType::Verilog,
        };
        let mut header = FstHeaderWriter::new(out, &info)?;
        let mut signals = Signals::declare(&mut header, &board, &numbers)?;
        let mut body = header.finish()?;
        let mut now = board.from;
        body.time_change(scale.at(now))?;
        for (at, number, new) in changes.in_order().map_err(io::Error::from)? {
            if at > now {
                signals.settle(&mut body)?;
                // Not at once: the library would lose what holds from the beginning.
                if now > board.from && body.size() > section {
                    body.flush()?;
                }
                now = at;
                body.time_change(scale.at(now))?;
            }
            signals.change(&mut body, number, new)?;
        }
        signals.settle(&mut body)?;
        body.time_change(scale.at(end.max(now)))?;
        body.finish()?.flush()?;
        Ok(())
    }
}

impl<W: Write + Seek> Chart for Waves<W> {
    fn state(&mut self, stage: usize, state: State, _: &Whose, from: u64, to: u64) {
        let wait = |kind, i: usize| FIRST_WAIT + 3 * i as u64 + kind;
        let state = match state {
            State::Busy => BUSY,
            State::Done => DONE,
            State::Waits(Cause::Starved(i)) => wait(0, i),
            State::Waits(Cause::Blocked(i)) => wait(1, i),
            State::Waits(Cause::Memory(i)) => wait(2, i),
        };
        self.hold(self.numbers.first_stage + stage, state, from, to);
    }

    fn level(&mut self, level: usize, at: u64, value: Value) {
        let value = match value {
            Value::Count(count) => count,
            Value::Real(real) => real.to_bits(),
        };
        self.changes.change(self.numbers.first_level + level, at, value);
    }

    fn moved(&mut self, channel: usize, transfer: Transfer, from: u64, to: u64) {
        let Transfer { client, write } = transfer;
        self.hold(self.numbers.first_bus + channel, 1 + 2 * client as u64 + u64::from(write), from, to);
    }

    fn open(&mut self, bank: usize, row: u64, from: u64, to: u64) {
        self.hold(self.numbers.first_bank + bank, row.saturating_add(1), from, to);
    }

    fn frame(&mut self, number: usize, from: u64, to: u64) {
        self.hold(FRAME, number as u64, from, to);
    }

    fn finish(mut self: Box<Self>, end: u64) -> io::Result<()> {
        for number in self.numbers.that_end() {
            if self.ends[number] < end {
                self.changes.change(number, self.ends[number], 0);
            }
        }
        self.write(end).map_err(|error| match error {
            FstWriteError::Io(error) => error,
            other => io::Error::other(other),
        })
    }
}
