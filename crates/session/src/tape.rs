//! Tapes: the work of a run in a file, from which [`retime`] makes the report that a run under other times gives.
//!
//! A tape is the line `basrelief-tape/1`, then pieces: a letter, the length in bytes (32 bits, lowest first), and so many bytes. `H`,
//! first, says in JSON which machine with which parameters; `R` is a [reel](Reel) of steps; `E`, last, says in JSON what is left of
//! the run beside its times, with the SHA-256 of the work. Files are compressed outside of this.

use crate::ended::Ended;
use crate::limits::{Kept, Recorded};
use crate::machines::{MachineConfig, MachineInfo, MachineSpec, for_machine};
use crate::run::Way;
use crate::settings::Limits;
use basrelief_input::{Budget, Held, OverBudget};
use basrelief_kernel::facts::Value as FactValue;
use basrelief_kernel::tape::Reel;
use basrelief_kernel::{self as kernel, NoProbe, Outcome, RetimeError, RunReport, Shape};
use basrelief_machines::ConfigProblem;
use basrelief_parameters::{ConfigError, Effect, Parameters};
use basrelief_report::Report;
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use std::borrow::Cow;
use std::io::{self, Read};

/// The first line of a tape.
const FIRST_LINE: &[u8] = b"basrelief-tape/1\n";
/// Longest piece that is taken in \[bytes\].
const LONGEST: u32 = 1 << 28;
/// Bytes of a reel, about.
pub(crate) const REEL_BYTES: usize = 1 << 20;

/// Parameters as the user gave them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Given {
    /// A file of TOML.
    pub toml: String,
    /// Single settings, over those of the file.
    pub settings: Vec<(String, String)>,
}

/// What is wrong with a tape, or with what it is to be timed with.
#[derive(Debug, thiserror::Error)]
pub enum TapeFileError {
    /// It cannot be read.
    #[error(transparent)]
    Read(#[from] io::Error),
    /// It is no tape, or not whole.
    #[error("not a tape: {0}; `basrelief run --tape FILE` makes one")]
    Format(String),
    /// What is recorded is no work of this machine.
    #[error(transparent)]
    Retime(#[from] RetimeError),
    /// A parameter that changes what units do.
    #[error("`{0}` changes what the units do, not only when: a tape holds that fast; run the machine with it")]
    Work(String),
    /// The parameters change what units do, if not by themselves.
    #[error("under these parameters the machine does other work than the tape holds: {0}; run the machine with them")]
    OtherWork(String),
    /// Parameters.
    #[error("{0}")]
    Config(String),
    /// The run does not come to its end: pictures and counts would be others.
    #[error("under these parameters the run does not come to its end: {0}")]
    Incomplete(String),
    /// Too much.
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
}

impl Given {
    /// The machine's configuration that these come to.
    fn config(&self, machine: &MachineInfo) -> Result<MachineConfig, TapeFileError> {
        machine.load(&self.toml, &self.with(&[])).map_err(|error| TapeFileError::Config(error.to_string()))
    }

    /// The configuration that these come to, with more settings over them.
    pub(crate) fn load<C: Parameters>(&self, more: &[(String, String)]) -> Result<C, ConfigError> {
        basrelief_parameters::load(&self.toml, &self.with(more))
    }

    fn with<'a>(&'a self, more: &'a [(String, String)]) -> Vec<(&'a str, &'a str)> {
        self.settings.iter().chain(more).map(|(key, value)| (key.as_str(), value.as_str())).collect()
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Head {
    version: String,
    machine: String,
    way: Way,
    given: Given,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct End {
    ended: Ended,
    figures: Vec<(String, FactValue)>,
    work: String,
}

/// The SHA-256 of a tape's work: of what each stage does, however its stream is cut into reels.
#[derive(Clone, Default)]
pub(crate) struct WorkHash(Vec<Sha256>);

impl WorkHash {
    pub(crate) fn add(&mut self, reel: &Reel) {
        self.0.resize(reel.streams().count(), Sha256::new());
        self.0.iter_mut().zip(reel.streams()).for_each(|(hash, stream)| hash.update(stream));
    }

    fn finish(self) -> String {
        let mut all = Sha256::new();
        self.0.into_iter().for_each(|stage| all.update(stage.finalize()));
        all.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

fn piece(letter: u8, bytes: &[u8]) -> Vec<u8> {
    let mut all = vec![letter];
    all.extend((bytes.len() as u32).to_le_bytes());
    all.extend_from_slice(bytes);
    all
}

/// The beginning of a tape.
pub(crate) fn head<S: MachineSpec>(way: Way, given: &Given) -> Vec<u8> {
    let version = env!("CARGO_PKG_VERSION").into();
    let head = Head { version, machine: S::NAME.into(), way, given: given.clone() };
    [FIRST_LINE, &piece(b'H', &serde_json::to_vec(&head).unwrap_or_default())].concat()
}

/// A reel of a tape.
pub(crate) fn reel(reel: &Reel) -> Vec<u8> {
    piece(b'R', &reel.to_bytes())
}

/// The end of a tape.
pub(crate) fn end(ended: &Ended, figures: Vec<(String, FactValue)>, work: WorkHash) -> Vec<u8> {
    let end = End { ended: ended.clone(), figures, work: work.finish() };
    piece(b'E', &serde_json::to_vec(&end).unwrap_or_default())
}

/// The pieces of a tape.
struct Pieces<'a> {
    reader: &'a mut dyn Read,
    budget: &'a Budget,
}

impl Pieces<'_> {
    /// The head, and the machine that it names.
    fn begin(&mut self) -> Result<(Head, &'static MachineInfo), TapeFileError> {
        let mut first = [0; FIRST_LINE.len()];
        self.fill(&mut first)?;
        if first != FIRST_LINE {
            return Err(TapeFileError::Format("it does not begin with `basrelief-tape/1`".into()));
        }
        let (b'H', bytes, _held) = self.next()? else { return Err(TapeFileError::Format("it has no head".into())) };
        let head: Head = parse(&bytes, "its head")?;
        let machine = MachineInfo::named(&head.machine).map_err(TapeFileError::Format)?;
        Ok((head, machine))
    }

    /// The letter and the bytes of the next piece.
    fn next(&mut self) -> Result<(u8, Vec<u8>, Held), TapeFileError> {
        let mut head = [0; 5];
        self.fill(&mut head)?;
        let [letter, length @ ..] = head;
        let length = u32::from_le_bytes(length);
        if length > LONGEST {
            return Err(TapeFileError::Format(format!("a piece of {length} bytes, expected at most {LONGEST}")));
        }
        // As it comes: a length alone takes no memory.
        let held = self.budget.take(length.into(), "a piece of a tape")?;
        let mut bytes = Vec::new();
        self.reader.take(length.into()).read_to_end(&mut bytes)?;
        if bytes.len() < length as usize {
            return Err(TapeFileError::Format("it ends within a piece".into()));
        }
        Ok((letter, bytes, held))
    }

    fn fill(&mut self, bytes: &mut [u8]) -> Result<(), TapeFileError> {
        self.reader.read_exact(bytes).map_err(|error| match error.kind() {
            io::ErrorKind::UnexpectedEof => TapeFileError::Format("it ends before its end".into()),
            _ => error.into(),
        })
    }
}

fn parse<T: for<'de> Deserialize<'de>>(bytes: &[u8], what: &str) -> Result<T, TapeFileError> {
    basrelief_input::from_slice(bytes)
        .map_err(|fault| TapeFileError::Format(format!("{what}: at `{}`: {}", fault.path, fault.message)))
}

/// How to time a tape again.
#[derive(Clone, Debug)]
pub struct RetimeOptions {
    /// Parameters over those of the run that was recorded, as `--set` takes them.
    pub settings: Vec<(String, String)>,
    /// As in [`RunOptions`](crate::RunOptions::limits).
    pub limits: Limits,
    /// For what the tape makes it hold.
    pub budget: Budget,
}

/// The report that a run gives with the parameters of the tape and these over them: without model, pictures, or units.
///
/// # Errors
/// See [`TapeFileError`].
pub fn retime(reader: &mut dyn Read, options: &RetimeOptions) -> Result<Report, TapeFileError> {
    let mut pieces = Pieces { reader, budget: &options.budget };
    let (head, machine) = pieces.begin()?;
    let table = machine.parameters();
    let works = |key: &str| table.iter().any(|p| p.key == key && p.effect == Effect::Work);
    if let Some((key, _)) = options.settings.iter().find(|(key, _)| works(key)) {
        return Err(TapeFileError::Work(key.clone()));
    }
    let recorded = head.given.config(machine)?;
    let mut given = head.given.clone();
    given.settings.extend(options.settings.iter().cloned());
    for_machine!(&given.config(machine)?, spec => timed_again((&recorded, spec, &given), head.way, pieces, options))
}

fn timed_again<S: MachineSpec>(
    (recorded, spec, given): (&MachineConfig, &S, &Given),
    way: Way,
    pieces: Pieces<'_>,
    options: &RetimeOptions,
) -> Result<Report, TapeFileError> {
    let recorded: S = serde_json::from_value(recorded.to_value()).map_err(|error| TapeFileError::Format(error.to_string()))?;
    let shape = same_work((&recorded, spec), way)?;
    // Where a user acts at times, what is drawn follows from times.
    if spec.rehearsed(&[]).is_some() {
        return Err(TapeFileError::OtherWork("its user acts at times".into()));
    }
    let mut reels = ReelsOfFile { pieces, work: WorkHash::default(), kept: Kept::new(options.limits), end: None, fault: None };
    let timed = kernel::retime(shape, &mut || reels.next(), &mut NoProbe, u64::MAX);
    // To its end: what is left of the run stands there.
    while timed.is_ok() && reels.next().is_ok_and(|reel| reel.is_some()) {}
    let ReelsOfFile { work, kept, end, fault, .. } = reels;
    if let Some(fault) = fault {
        return Err(fault);
    }
    let run = timed?;
    if run.outcome != Outcome::Complete {
        return Err(TapeFileError::Incomplete(outcome_text(&run.outcome)));
    }
    let Some(End { ended, figures, work: stated }) = end else { return Err(TapeFileError::Format("it has no end".into())) };
    if work.finish() != stated {
        return Err(TapeFileError::Format("its work has another SHA-256 than it says".into()));
    }
    let mut facts = way.facts(spec).map_err(config)?;
    facts.put(&figures);
    let mut report = ended.report(spec, facts, Some(&run));
    if let Some(reels) = kept.as_ref().and_then(Kept::reels) {
        Recorded { spec, given, way, reels, run: &run }.measure(&mut report);
    }
    Ok(report)
}

pub(crate) fn config(error: ConfigProblem) -> TapeFileError {
    TapeFileError::Config(error.to_string())
}

fn outcome_text(outcome: &Outcome) -> String {
    match outcome {
        Outcome::Deadlock(deadlock) => deadlock.to_string(),
        other => format!("{other:?}"),
    }
}

/// The shape of a machine that does the work of another, behind the same way in: as far as shapes tell, and what its units are built of.
fn same_work<S: MachineSpec>((recorded, spec): (&S, &S), way: Way) -> Result<Shape, TapeFileError> {
    let shape = way.shape(spec).map_err(config)?;
    way.shape(recorded).map_err(config)?.same_work(&shape).map_err(TapeFileError::OtherWork)?;
    let of_units = |spec: &S| way.facts(spec).map(|facts| facts.hardware_of_units().cloned().collect::<Vec<_>>());
    if of_units(recorded).map_err(config)? != of_units(spec).map_err(config)? {
        return Err(TapeFileError::OtherWork("its units are built of other hardware".into()));
    }
    Ok(shape)
}

/// The reels of a tape, as they are read.
struct ReelsOfFile<'a> {
    pieces: Pieces<'a>,
    work: WorkHash,
    /// Those that are timed again, for limits.
    kept: Option<Kept>,
    end: Option<End>,
    fault: Option<TapeFileError>,
}

impl ReelsOfFile<'_> {
    /// The next reel, for the kernel: it is told that there is a fault, and we keep what it is.
    fn next(&mut self) -> Result<Option<Cow<'static, Reel>>, String> {
        if self.end.is_some() || self.fault.is_some() {
            return Ok(None);
        }
        self.read().map(|reel| reel.map(Cow::Owned)).map_err(|fault| {
            let text = fault.to_string();
            self.fault = Some(fault);
            text
        })
    }

    fn read(&mut self) -> Result<Option<Reel>, TapeFileError> {
        let (letter, bytes, _held) = self.pieces.next()?;
        match letter {
            b'R' => {
                let reel = Reel::from_bytes(&bytes).map_err(RetimeError::from)?;
                self.work.add(&reel);
                if let Some(kept) = &mut self.kept {
                    kept.keep(reel.clone());
                }
                Ok(Some(reel))
            }
            b'E' => {
                self.end = Some(parse(&bytes, "its end")?);
                Ok(None)
            }
            other => Err(TapeFileError::Format(format!("a piece `{}`, expected R or E", other.escape_ascii()))),
        }
    }
}

/// The run of these reels on a machine of this shape.
pub(crate) fn timed(reels: &[Reel], shape: Shape) -> Result<RunReport, RetimeError> {
    let mut reels = reels.iter().map(Cow::Borrowed);
    kernel::retime(shape, &mut || Ok(reels.next()), &mut NoProbe, u64::MAX)
}

/// A whole tape in memory.
pub(crate) struct Loaded {
    machine: &'static MachineInfo,
    pub(crate) given: Given,
    pub(crate) way: Way,
    pub(crate) reels: Vec<Reel>,
    _held: Held,
}

impl Loaded {
    /// Reads it, to its end.
    pub(crate) fn read(reader: &mut dyn Read, budget: &Budget) -> Result<Self, TapeFileError> {
        let mut pieces = Pieces { reader, budget };
        let (head, machine) = pieces.begin()?;
        let mut reels = ReelsOfFile { pieces, work: WorkHash::default(), kept: None, end: None, fault: None };
        let (mut all, mut held) = (Vec::new(), budget.nothing());
        while let Some(reel) = reels.read()? {
            held.grow(reel.streams().map(<[u8]>::len).sum::<usize>() as u64, "a tape")?;
            all.push(reel);
        }
        match reels.end {
            Some(end) if end.work == reels.work.finish() => {
                Ok(Self { machine, given: head.given, way: head.way, reels: all, _held: held })
            }
            _ => Err(TapeFileError::Format("its work has another SHA-256 than it says".into())),
        }
    }

    pub(crate) fn config(&self) -> Result<MachineConfig, TapeFileError> {
        self.given.config(self.machine)
    }
}
