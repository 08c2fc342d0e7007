//! Times the work on a tape again: the timed engine, with steps from a tape in place of those of units.

use super::ends::advance;
use super::timed::RunAhead;
use super::work::Work;
use crate::asked::Asks;
use crate::report::RunReport;
use crate::shape::Shape;
use crate::tape::{Reader, Reel, TapeError};
use crate::time::{Halt, Made, Path, Rest, Takes, Time, Visit};
use crate::{CriticalPath, Cycle, Demand, Groups, NoProbe, Outcome, Probe, Traffic};
use std::borrow::Cow;
use std::fmt;

/// Why a tape cannot be timed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RetimeError {
    /// What is on the tape is no work.
    Tape(TapeError),
    /// It is the work of another machine.
    Stages {
        /// Stages of the tape.
        found: usize,
        /// Stages of the machine.
        expected: usize,
    },
    /// A stage can go on, but the run that was recorded did not go so far.
    EndsEarly(String),
    /// A step does what its stage cannot.
    Fault(String),
    /// The tape could not be read.
    Read(String),
}

impl fmt::Display for RetimeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tape(error) => error.fmt(f),
            Self::Stages { found, expected } => write!(f, "the tape has {found} stages, but the machine has {expected}"),
            Self::EndsEarly(stage) => write!(
                f,
                "under these parameters `{stage}` goes on beyond what was recorded: record a run that is complete, or that goes as far"
            ),
            Self::Fault(text) | Self::Read(text) => f.write_str(text),
        }
    }
}

impl std::error::Error for RetimeError {}

impl From<TapeError> for RetimeError {
    fn from(error: TapeError) -> Self {
        Self::Tape(error)
    }
}

/// Gives the reels of a tape in order, and none after the last; or says why it cannot be read. It is told how many bytes of those
/// before are still to be timed.
pub type Reels<'a, 'f> = dyn FnMut(usize) -> Result<Option<Cow<'f, Reel>>, String> + 'a;

impl Work for Reader {
    type Declared = ();

    #[inline]
    fn next(&self) -> ((), Takes) {
        ((), self.takes())
    }

    #[inline]
    fn has_step(&self) -> bool {
        self.has_step()
    }

    #[inline]
    fn step(&mut self, (): (), _: &mut Traffic) -> Made {
        self.step()
    }

    #[inline]
    fn is_silent(&self, _: &Traffic) -> bool {
        self.is_silent()
    }

    #[inline]
    fn asks<'a>(&'a mut self, traffic: &'a mut Traffic, _: &mut Visit<'_>) -> Option<Asks<'a>> {
        self.asks(traffic)
    }

    #[inline]
    fn go_on(&mut self, _: &mut Traffic) {
        self.go_on();
    }
}

/// Times the work on a tape on a machine of this shape: the report that a run of it gives.
///
/// The tape must be of the same machine with the same [work](Shape::same_work).
///
/// # Errors
/// See [`RetimeError`].
pub fn retime<P: Probe>(
    shape: Shape,
    reels: &mut Reels<'_, '_>,
    probe: &mut P,
    max_cycles: u64,
) -> Result<RunReport, RetimeError> {
    let readers = new_readers(&shape);
    Ok(timed_again((shape, readers), reels, (probe, Wanted::Report), max_cycles)?.0)
}

/// Times the work on a tape, and finds what its end waited for, back to its beginning. It keeps up to `most_events` of 16 bytes, some
/// three per step: where that is too few, or the run is not complete, there is no path. `groups`: of the steps of each stage; or none.
///
/// # Errors
/// See [`RetimeError`].
pub fn critical_path(
    shape: Shape,
    reels: &mut Reels<'_, '_>,
    most_events: usize,
    groups: &[Groups],
) -> Result<Option<CriticalPath>, RetimeError> {
    let readers = new_readers(&shape);
    Ok(timed_again((shape, readers), reels, (&mut NoProbe, Wanted::Path(most_events, groups)), u64::MAX)?.1)
}

fn new_readers(shape: &Shape) -> Vec<Reader> {
    shape.stages.iter().map(|stage| Reader::new(stage, &shape.memories)).collect()
}

/// A tape that is timed more than once: its steps are read once, and their look-ups made once, for the machine that it is timed on
/// first and all that have the same caches.
#[derive(Clone, Debug)]
pub struct Tape<'a> {
    reels: Cow<'a, [Reel]>,
    /// Of each stage; none where the tape is too long to be held so, or wrong.
    readers: Option<Vec<Reader>>,
    /// Most that the steps of a stage may take \[bytes\].
    room: u64,
}

impl<'a> Tape<'a> {
    /// All of a tape, read for a machine of this shape. Its steps are held where they take no more than about `room` bytes; otherwise it
    /// is read for each timing.
    pub fn new(reels: impl Into<Cow<'a, [Reel]>>, shape: &Shape, room: u64) -> Self {
        let room = room / shape.stages.len().max(1) as u64;
        let mut tape = Self { reels: reels.into(), readers: None, room };
        let is_ours = tape.reels.iter().all(|reel| reel.stages.len() == shape.stages.len());
        tape.readers = if is_ours { (0..shape.stages.len()).map(|stage| tape.read(stage, shape)).collect() } else { None };
        tape
    }

    fn read(&self, stage: usize, shape: &Shape) -> Option<Reader> {
        let pieces = self.reels.iter().filter_map(|reel| reel.piece(stage));
        Reader::whole(&shape.stages[stage], &shape.memories, pieces, self.room)
    }

    /// As [`retime`].
    ///
    /// # Errors
    /// See [`RetimeError`].
    pub fn retime(&self, shape: Shape) -> Result<RunReport, RetimeError> {
        Ok(self.timed_again(shape, Wanted::Report)?.0)
    }

    /// Cycles [up to the last mark](RunReport::marked_cycles), and nothing else: in seven eighths of the instructions. None where the
    /// run is not complete.
    ///
    /// # Errors
    /// See [`RetimeError`].
    pub fn cycles(&self, shape: Shape) -> Result<Option<u64>, RetimeError> {
        let (report, _) = self.timed_again(shape, Wanted::Cycles)?;
        Ok((report.outcome == Outcome::Complete).then(|| report.marked_cycles()))
    }

    /// As [`critical_path`].
    ///
    /// # Errors
    /// See [`RetimeError`].
    pub fn critical_path(
        &self,
        shape: Shape,
        most_events: usize,
        groups: &[Groups],
    ) -> Result<Option<CriticalPath>, RetimeError> {
        Ok(self.timed_again(shape, Wanted::Path(most_events, groups))?.1)
    }

    fn timed_again(&self, shape: Shape, wanted: Wanted<'_>) -> Result<(RunReport, Option<CriticalPath>), RetimeError> {
        let fitting = |(stage, reader): (usize, &Reader)| {
            let fits = reader.fits(&shape.stages[stage], &shape.memories);
            if fits { Some(reader.clone()) } else { self.read(stage, &shape) }
        };
        let readers = self.readers.as_ref().filter(|readers| readers.len() == shape.stages.len());
        let readers: Option<Vec<Reader>> = readers.and_then(|readers| readers.iter().enumerate().map(fitting).collect());
        let mut reels = self.reels.iter().map(Cow::Borrowed).skip(if readers.is_some() { self.reels.len() } else { 0 });
        let readers = readers.unwrap_or_else(|| new_readers(&shape));
        timed_again((shape, readers), &mut |_| Ok(reels.next()), (&mut NoProbe, wanted), u64::MAX)
    }
}

/// What is wanted of a run.
enum Wanted<'a> {
    /// Its cycles.
    Cycles,
    /// All of its report.
    Report,
    /// Its critical path: of how many events at most, and by which groups.
    Path(usize, &'a [Groups]),
}

/// The report, and the critical path where it is wanted.
fn timed_again<P: Probe>(
    (shape, mut readers): (Shape, Vec<Reader>),
    reels: &mut Reels<'_, '_>,
    (probe, wanted): (&mut P, Wanted<'_>),
    max_cycles: u64,
) -> Result<(RunReport, Option<CriticalPath>), RetimeError> {
    let mut time = Time::new(shape);
    time.keep_fills(&*probe);
    if readers.iter().any(|reader| reader.demand().is_none()) {
        feed(&mut readers, reels, &time)?;
    }
    let path = match wanted {
        Wanted::Path(most, groups) => Some(Path::new(&mut time, most, groups)),
        Wanted::Report => None,
        Wanted::Cycles => {
            time.account_for_nothing();
            None
        }
    };
    let mut walk = RunAhead::new(&mut time, probe, max_cycles, None);
    walk.path = path;
    let halt = loop {
        walk.begin();
        for (number, reader) in readers.iter_mut().enumerate() {
            advance(&mut walk, number, reader);
        }
        if let Some(fault) = walk.fault.take() {
            return Err(RetimeError::Fault(fault));
        }
        if let Some(error) = readers.iter_mut().find_map(|reader| reader.error.take()) {
            return Err(error.into());
        }
        walk.time.show_fills(walk.probe, None);
        if walk.goes_on() {
            continue;
        }
        if !walk.hungry {
            break if walk.limited { Halt::Limit(max_cycles) } else { Halt::Quiet };
        }
        feed(&mut readers, reels, walk.time)?;
    };
    let path = walk.path;
    time.land_all();
    let rest = |reader: &Reader| Rest {
        demand: reader.demand().unwrap_or(Demand::Finished),
        empty: reader.is_empty() && !reader.has_step(),
    };
    let rests: Vec<Rest> = readers.iter().map(rest).collect();
    let report = time.conclude(&rests, halt);
    time.show_fills(probe, Some(Cycle(report.total)));
    let path = path.filter(|_| report.outcome == Outcome::Complete);
    let path = path.and_then(|path| path.trace(&time, report.total, &report.marks));
    Ok((report, path))
}

/// Goes on with the next reel, which a stage needs.
fn feed(readers: &mut [Reader], reels: &mut Reels<'_, '_>, time: &Time) -> Result<(), RetimeError> {
    let waiting = readers.iter().map(Reader::waiting).sum();
    let Some(reel) = reels(waiting).map_err(RetimeError::Read)? else {
        let needs = |&stage: &usize| {
            let demand = readers[stage].demand().unwrap_or(Demand::Finished);
            !readers[stage].has_step() && time.next_start(stage, demand).is_known()
        };
        let stage = (0..readers.len()).find(needs).unwrap_or_default();
        return Err(RetimeError::EndsEarly(time.shape.stages[stage].names.name.clone()));
    };
    if reel.stages.len() != readers.len() {
        return Err(RetimeError::Stages { found: reel.stages.len(), expected: readers.len() });
    }
    reel.feed(readers);
    Ok(())
}
