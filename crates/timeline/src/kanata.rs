//! Life of single tokens, for the pipeline viewer Konata: a token takes the place of an instruction.
//!
//! Lane 0 shows the location of a token: the unit that processes it, then the FIFO in which it waits for the next unit. Lane 1 shows the
//! stalls of that unit on memory or on a full FIFO. A token that reaches the end of the pixel pipeline is retired. A hidden token is
//! flushed at the unit that removes it. A token that leaves the shown units or cycles, or is in flight at the end of an incomplete run, is
//! retired there, because its end is unknown. Its hover text lists the units with their cycles.
//!
//! The format, Kanata 4, counts cycles forwards only, but events are known token by token. So events are kept until the end.

use crate::layout::{TimelineLayout, wait_name};
use crate::levels::CounterValue;
use crate::probe::{BusTransfer, StepAttribution, TokenLife, TraceSink, UnitState};
use basrelief_input::{MemoryPool, MemoryReservation, OverBudget};
use basrelief_kernel::StallCause;
use std::collections::BTreeMap;
use std::io::{self, Write};

/// Lanes of the location of a token, and of its stalls.
const STAGES: u8 = 0;
const STALLS: u8 = 1;

/// A unit was at work for a token, or waited with it.
#[derive(Clone, Copy, Debug)]
struct TokenSpan {
    life: TokenLife,
    whose: StepAttribution,
    stage: usize,
    state: UnitState,
    from: u64,
    to: u64,
}

/// An event of a token. Events of one token and cycle are written in this order.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum TokenEvent {
    /// Its label, and its hover text.
    Begins(String, String),
    Leaves(u8, String),
    Enters(u8, String),
    Ends {
        flushed: bool,
    },
}

/// Writes the lives of tokens. [`TraceSink::finish`] returns errors.
#[derive(Debug)]
pub struct KanataLog<W> {
    out: W,
    board: TimelineLayout,
    /// Number of the stage where pixels end.
    last: Option<usize>,
    pieces: Vec<TokenSpan>,
    held: MemoryReservation,
    over: Option<OverBudget>,
}

impl<W: Write> KanataLog<W> {
    /// Creates a log for a machine that retires tokens in its `last` stage. Events that are kept until the end count towards the memory
    /// limit.
    pub fn new(out: W, board: &TimelineLayout, last: Option<usize>, budget: &MemoryPool) -> Self {
        Self { out, board: board.clone(), last, pieces: vec![], held: budget.empty_reservation(), over: None }
    }

    /// The FIFO between two stages.
    fn between(&self, from: usize, to: usize) -> &str {
        let fifo = self.board.diagram.fifos.iter().find(|fifo| fifo.ends == [from, to]);
        fifo.map_or("under way", |fifo| &fifo.name)
    }

    /// Returns true if a token reaches the stage where pixels end.
    fn arrives(&self, pieces: &[TokenSpan]) -> bool {
        pieces.iter().any(|piece| Some(piece.stage) == self.last)
    }

    /// Returns the number of the first token that may still be under way at the end of the shown cycles. Each token before it that does
    /// not arrive has been removed. If all of a complete run is shown, no token is under way. Without the last stage, the end of no token
    /// is shown.
    fn first_unfinished(&self, pieces: &[TokenSpan], is_all: bool) -> u64 {
        if !self.last.is_some_and(|last| self.board.shows(last)) {
            return 0;
        }
        if is_all {
            return u64::MAX;
        }
        let arrived = pieces.iter().filter(|piece| self.arrives(std::slice::from_ref(piece)));
        arrived.map(|piece| piece.life.number).max().unwrap_or(0)
    }

    /// Events of one token, by cycle.
    fn events(&self, pieces: &[TokenSpan], first_unfinished: u64) -> Vec<(u64, TokenEvent)> {
        let Some(first) = pieces.first() else { return vec![] };
        let mut events = vec![(first.from, TokenEvent::Begins(label(first), self.hover_text(pieces)))];
        let (mut is_in, mut end) = (None::<usize>, first.from);
        for piece in pieces {
            let name = match piece.state {
                UnitState::Waits(of) => {
                    let stall = self.stall(piece.stage, of);
                    events.push((piece.from, TokenEvent::Enters(STALLS, stall.clone())));
                    events.push((piece.to, TokenEvent::Leaves(STALLS, stall)));
                    continue;
                }
                UnitState::Busy | UnitState::Done => self.board.name(piece.stage),
            };
            if let Some(before) = is_in.filter(|before| *before != piece.stage) {
                // The bar of a unit ends where the next unit begins, even if the unit continues.
                let left = end.min(piece.from);
                events.push((left, TokenEvent::Leaves(STAGES, self.board.name(before))));
                if left < piece.from {
                    let fifo = self.between(before, piece.stage);
                    events.push((left, TokenEvent::Enters(STAGES, fifo.into())));
                    events.push((piece.from, TokenEvent::Leaves(STAGES, fifo.into())));
                }
            }
            if is_in != Some(piece.stage) {
                events.push((piece.from, TokenEvent::Enters(STAGES, name)));
            }
            (is_in, end) = (Some(piece.stage), end.max(piece.to));
        }
        let Some(stage) = is_in else { return vec![] };
        events.push((end, TokenEvent::Leaves(STAGES, self.board.name(stage))));
        let flushed = first.life.number < first_unfinished && !self.arrives(pieces);
        events.push((end, TokenEvent::Ends { flushed }));
        events
    }

    /// Returns the units of a token with their cycles, one per line. The format writes a line feed as `\\n`.
    fn hover_text(&self, pieces: &[TokenSpan]) -> String {
        let level = pieces.iter().find_map(|piece| piece.whose.level).map(|level| format!("MIP level {level}"));
        let visit = |pieces: &[TokenSpan]| {
            let (mut busy, mut waits) = (0, BTreeMap::new());
            for piece in pieces {
                match piece.state {
                    UnitState::Waits(of) => *waits.entry(self.stall(piece.stage, of)).or_insert(0) += piece.to - piece.from,
                    UnitState::Busy | UnitState::Done => busy += piece.to - piece.from,
                }
            }
            let waits: String = waits.iter().map(|(of, cycles)| format!(", {of} {cycles}")).collect();
            format!("{}: from cycle {}, busy {busy}{waits}", self.board.name(pieces[0].stage), pieces[0].from)
        };
        let visits = pieces.chunk_by(|a, b| a.stage == b.stage).map(visit);
        level.into_iter().chain(visits).collect::<Vec<_>>().join("\\n")
    }

    fn stall(&self, stage: usize, of: StallCause) -> String {
        wait_name(&self.board.diagram.stages[stage], of)
    }

    fn write(&mut self, is_all: bool) -> io::Result<()> {
        let mut pieces = std::mem::take(&mut self.pieces);
        pieces.sort_by_key(|piece| (piece.life.number, piece.from, piece.to, piece.stage));
        let first_unfinished = self.first_unfinished(&pieces, is_all);
        let lives = pieces.chunk_by(|a, b| a.life.number == b.life.number);
        let mut events: Vec<(u64, u64, usize, TokenEvent)> = vec![];
        for life in lives {
            let of_life = self.events(life, first_unfinished);
            self.held.try_grow(of_life.len() as u64 * size_of::<(u64, u64, usize, TokenEvent)>() as u64, "lives of tokens")?;
            events.extend((0..).zip(of_life).map(|(k, (at, event))| (at, life[0].life.number, k, event)));
        }
        // The order within a token stays, and the file runs forwards in time.
        events.sort();
        let Self { out, .. } = self;
        writeln!(out, "Kanata\t0004")?;
        let mut now = events.first().map_or(self.board.from, |event| event.0);
        writeln!(out, "C=\t{now}")?;
        let (mut ids, mut retired) = (BTreeMap::new(), 0);
        for (at, life, _, event) in events {
            if at > now {
                writeln!(out, "C\t{}", at - now)?;
                now = at;
            }
            let count = ids.len();
            let id = *ids.entry(life).or_insert(count);
            match event {
                TokenEvent::Begins(label, hover) => {
                    writeln!(out, "I\t{id}\t{life}\t0\nL\t{id}\t0\t{label}\nL\t{id}\t1\t{hover}")?;
                }
                TokenEvent::Enters(lane, name) => writeln!(out, "S\t{id}\t{lane}\t{name}")?,
                TokenEvent::Leaves(lane, name) => writeln!(out, "E\t{id}\t{lane}\t{name}")?,
                TokenEvent::Ends { flushed } => {
                    writeln!(out, "R\t{id}\t{retired}\t{}", u8::from(flushed))?;
                    retired += u64::from(!flushed);
                }
            }
        }
        out.flush()
    }
}

/// Label of a token: its attribution and its pixel.
fn label(TokenSpan { life, whose, .. }: &TokenSpan) -> String {
    let numbers = [("frame", whose.frame.map(|frame| frame + 1)), ("object", whose.object), ("polygon", whose.polygon)];
    let mut label: Vec<String> = numbers.into_iter().filter_map(|(what, number)| Some(format!("{what} {}", number?))).collect();
    if let Some([x, y]) = life.pixel {
        let more = if life.pixels > 1 { format!(" and {} more", life.pixels - 1) } else { String::new() };
        label.push(format!("pixel {x}, {y}{more}"));
    }
    if label.is_empty() { format!("token {}", life.number) } else { label.join(", ") }
}

impl<W: Write> TraceSink for KanataLog<W> {
    fn state(&mut self, stage: usize, state: UnitState, whose: &StepAttribution, from: u64, to: u64) {
        let Some(life) = whose.life.filter(|_| self.over.is_none()) else { return };
        // That a unit waits for the token is nothing that the token does.
        if matches!(state, UnitState::Waits(StallCause::Starved(_)) | UnitState::Done) {
            return;
        }
        match self.held.make_room(&mut self.pieces, 1, "lives of tokens") {
            Ok(()) => self.pieces.push(TokenSpan { life, whose: *whose, stage, state, from, to }),
            Err(over) => {
                self.over = Some(over);
                self.pieces = vec![];
            }
        }
    }

    fn level(&mut self, _: usize, _: u64, _: CounterValue) {}

    fn moved(&mut self, _: usize, _: BusTransfer, _: u64, _: u64) {}

    fn open(&mut self, _: usize, _: u64, _: u64, _: u64) {}

    fn frame(&mut self, _: usize, _: u64, _: u64) {}

    fn finish(mut self: Box<Self>, _: u64, is_all: bool) -> io::Result<()> {
        self.over.take().map_or(Ok(()), Err)?;
        self.write(is_all)
    }
}
