//! Waves in the format FST, for GTKWave and Surfer.
//!
//! | scope | signals |
//! |---|---|
//! | the machine | `frame`, the number of the frame, 0 behind the last |
//! | a unit, with its numeral | `busy`, `starved`, `blocked`, `memory`, `done`: one of them is 1 |
//! | a FIFO | `fill`, the occupied slots; `ready`, a slot is free; `valid`, a token is visible |
//! | a channel of a memory | `queue`, `bytes_per_cycle`, `bus_use`; `bus`, it moves data; `write`, and `client_NAME` of the client of the transfer |
//! | a bank in it | `open`, and its `row` |
//! | a client | `credits`, the remaining credits |
//! | a cache | `hit_rate` |
//!
//! Each state and each client is a wire of one bit: FST has named states, but the library that writes it has not, and a number is hard to read. `valid`
//! is 1 from the cycle in which a token becomes visible to the cycle of its pop. `fill` also counts reserved slots.
//!
//! FST is written in order of time, and events of one unit may be far ahead of another. So [`FstWaves`] keeps all changes within a memory
//! limit, in about three bytes each, and writes at the end of the run. A temporary file to sort them in was rejected: it needs a file
//! system, and a run that does not fit is too long to look through; `--from-cycle` selects a part of it.

use crate::layout::TimelineLayout;
use crate::levels::CounterValue;
use crate::probe::{BusTransfer, StepAttribution, TraceSink, UnitState};
use crate::scale::TimeScale;
use crate::streams::ChangeStreams;
use crate::wires::{BUSY, DONE, FIRST_WAIT, FRAME, SignalNumbers, SignalTable};
use basrelief_input::MemoryPool;
use basrelief_kernel::StallCause;
use fst_writer::{FstFileType, FstHeaderWriter, FstInfo, FstWriteError};
use std::io::{self, Seek, SeekFrom, Write};

/// Date of all files, as `asctime` prints it: the epoch, so that equal runs give equal files.
const DATE: &str = "Thu Jan  1 00:00:00 1970\n";
/// Offset of the start time in the file, behind the kind and the length of the header.
const START_OFFSET: u64 = 9;
/// Bytes of changes that are written at once.
const SECTION: usize = 1 << 22;

/// Writes waves at the end of the run.
#[derive(Debug)]
pub struct FstWaves<W> {
    out: W,
    board: TimelineLayout,
    numbers: SignalNumbers,
    changes: ChangeStreams,
    /// When the last state of each stage, bus and bank ends, by the number of its value.
    ends: Vec<u64>,
    pub(crate) section: usize,
}

impl<W: Write + Seek> FstWaves<W> {
    /// Creates an empty file. Kept changes count towards the memory limit.
    pub fn new(out: W, board: &TimelineLayout, budget: &MemoryPool) -> Self {
        let numbers = SignalNumbers::new(board);
        let changes = ChangeStreams::new(numbers.count, budget);
        Self { out, board: board.clone(), changes, ends: vec![board.from; numbers.count], numbers, section: SECTION }
    }

    /// Sets a value from cycle `from` to the cycle before `to`. Outside of such intervals it is 0.
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
        let (scale, timescale_exponent) = TimeScale::whole(board.hz);
        let info = FstInfo {
            start_time: 0,
            timescale_exponent,
            version: concat!("basrelief ", env!("CARGO_PKG_VERSION")).into(),
            date: DATE.into(),
            file_type: FstFileType::Verilog,
        };
        let mut header = FstHeaderWriter::new(out, &info)?;
        let signals = SignalTable::declare(&mut header, &board, &numbers)?;
        let mut body = header.finish()?;
        let mut now = board.from;
        body.time_change(scale.at(now))?;
        for (at, number, new) in changes.in_order().map_err(io::Error::from)? {
            if at > now {
                // Not at once: the library would lose values that hold from the start.
                if now > board.from && body.size() > section {
                    body.flush()?;
                }
                now = at;
                body.time_change(scale.at(now))?;
            }
            signals.change(&mut body, number, new)?;
        }
        body.time_change(scale.at(end.max(now)))?;
        let mut out = body.finish()?;
        // The library writes 0, so that GTKWave would open at cycle 0 instead of the first shown cycle.
        out.seek(SeekFrom::Start(START_OFFSET))?;
        out.write_all(&scale.at(board.from).to_be_bytes())?;
        out.seek(SeekFrom::End(0))?;
        out.flush()?;
        Ok(())
    }
}

impl<W: Write + Seek> TraceSink for FstWaves<W> {
    fn shows_visible(&self) -> bool {
        true
    }

    fn state(&mut self, stage: usize, state: UnitState, _: &StepAttribution, from: u64, to: u64) {
        let wait = |kind, i: usize| FIRST_WAIT + 3 * i as u64 + kind;
        let state = match state {
            UnitState::Busy => BUSY,
            UnitState::Done => DONE,
            UnitState::Waits(StallCause::Starved(i)) => wait(0, i),
            UnitState::Waits(StallCause::Blocked(i)) => wait(1, i),
            UnitState::Waits(StallCause::Memory(i)) => wait(2, i),
        };
        self.hold(self.numbers.first_stage + stage, state, from, to);
    }

    fn level(&mut self, level: usize, at: u64, value: CounterValue) {
        let value = match value {
            CounterValue::Count(count) => count,
            CounterValue::Real(real) => real.to_bits(),
        };
        self.changes.change(self.numbers.first_level + level, at, value);
    }

    fn moved(&mut self, channel: usize, transfer: BusTransfer, from: u64, to: u64) {
        let BusTransfer { client, write } = transfer;
        self.hold(self.numbers.first_bus + channel, 1 + 2 * client as u64 + u64::from(write), from, to);
    }

    fn open(&mut self, bank: usize, row: u64, from: u64, to: u64) {
        self.hold(self.numbers.first_bank + bank, row.saturating_add(1), from, to);
    }

    fn frame(&mut self, number: usize, from: u64, to: u64) {
        self.hold(FRAME, number as u64, from, to);
    }

    fn finish(mut self: Box<Self>, end: u64, _: bool) -> io::Result<()> {
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
