//! Tapes: the work of a run in a file, from which [`retime`] makes the report that a run under other times gives.
//!
//! A tape is the line `basrelief-tape/1`, then pieces: a letter, the length in bytes (32 bits, lowest first), and so many bytes. `H`,
//! first, says in JSON which machine with which parameters; `R` is a [reel](RecordingChunk) of steps; `E`, last, says in JSON what is left of
//! the run beside its times, with the SHA-256 of the work. Files are compressed outside of this.

mod loaded;
mod pieces;
mod recording;
mod retime;

pub(crate) use loaded::Loaded;
pub use recording::Recording;
pub use retime::{RetimeOptions, retime, retime_to};
pub(crate) use retime::{config, same_work};

use crate::ended::Ended;
use crate::limits::Kept;
use crate::machines::{MachineConfig, MachineInfo, MachineSpec};
use crate::run::Way;
use basrelief_input::OverBudget;
use basrelief_kernel::ResimulateError;
use basrelief_kernel::recording::RecordingChunk;
use basrelief_kernel::stats::FigureValue as FactValue;
use basrelief_parameters::{ConfigError, Parameters};
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use std::io;

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
    Retime(#[from] ResimulateError),
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
    /// It is of another run than the report beside it, or a version made it under which time passes otherwise.
    #[error("it is no tape of the run that the report beside it tells of")]
    OtherRun,
    /// Too much.
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
}

impl Given {
    /// The machine's configuration that these come to, with more settings over them.
    ///
    /// # Errors
    /// What the machine has not, or cannot be.
    pub fn config(&self, machine: &MachineInfo, more: &[(String, String)]) -> Result<MachineConfig, TapeFileError> {
        machine.load(&self.toml, &self.with(more)).map_err(|error| TapeFileError::Config(error.to_string()))
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

/// Bytes of work on a reel.
pub(crate) fn bytes_of(reel: &RecordingChunk) -> usize {
    reel.streams().map(<[u8]>::len).sum()
}

/// The SHA-256 of a tape's work: of what each stage does, however its stream is cut into reels.
#[derive(Clone, Default)]
pub(crate) struct WorkHash {
    stages: Vec<Sha256>,
    bytes: usize,
}

impl WorkHash {
    pub(crate) fn add(&mut self, reel: &RecordingChunk) {
        self.stages.resize(reel.streams().count(), Sha256::new());
        self.stages.iter_mut().zip(reel.streams()).for_each(|(hash, stream)| hash.update(stream));
        self.bytes += bytes_of(reel);
    }

    /// Whether it is no more than is timed again where nobody asks for it.
    pub(crate) fn is_short(&self) -> bool {
        self.bytes <= Kept::SHORT
    }

    fn finish(self) -> String {
        let mut all = Sha256::new();
        self.stages.into_iter().for_each(|stage| all.update(stage.finalize()));
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
pub(crate) fn reel(reel: &RecordingChunk) -> Vec<u8> {
    piece(b'R', &reel.to_bytes())
}

/// The end of a tape.
pub(crate) fn end(ended: &Ended, figures: Vec<(String, FactValue)>, work: WorkHash) -> Vec<u8> {
    let end = End { ended: ended.clone(), figures, work: work.finish() };
    piece(b'E', &serde_json::to_vec(&end).unwrap_or_default())
}
