//! Reading a tape, piece by piece.

use super::{End, FIRST_LINE, Head, LONGEST, TapeFileError, WorkHash, bytes_of, piece};
use crate::limits::Kept;
use crate::machines::MachineInfo;
use crate::observer::Observer;
use basrelief_input::{Budget, Held};
use basrelief_kernel::ResimulateError;
use basrelief_kernel::recording::RecordingChunk;
use serde::Deserialize;
use std::borrow::Cow;
use std::io::{self, Read};

/// The pieces of a tape.
pub(super) struct Pieces<'a> {
    pub(super) reader: &'a mut dyn Read,
    pub(super) budget: &'a Budget,
}

impl Pieces<'_> {
    /// The head, and the machine that it names.
    pub(super) fn begin(&mut self) -> Result<(Head, &'static MachineInfo), TapeFileError> {
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

/// The reels of a tape, as they are read.
pub(super) struct ReelsOfFile<'a> {
    pieces: Pieces<'a>,
    /// Is shown them.
    observer: Option<&'a mut dyn Observer>,
    pub(super) work: WorkHash,
    /// Those that are timed again, for limits.
    pub(super) kept: Option<Kept>,
    pub(super) end: Option<End>,
    pub(super) fault: Option<TapeFileError>,
    /// Of what is read, and not timed yet.
    pub(super) waiting: Held,
}

impl<'a> ReelsOfFile<'a> {
    pub(super) fn new(pieces: Pieces<'a>, observer: Option<&'a mut dyn Observer>, kept: Option<Kept>) -> Self {
        let waiting = pieces.budget.nothing();
        Self { pieces, observer, work: WorkHash::default(), kept, end: None, fault: None, waiting }
    }

    /// The next reel, for the kernel, which has so many bytes left of those before: it is told that there is a fault, and we keep what it is.
    pub(super) fn next(&mut self, waiting: usize) -> Result<Option<Cow<'static, RecordingChunk>>, String> {
        if self.end.is_some() || self.fault.is_some() {
            return Ok(None);
        }
        self.waiting.shrink_to(waiting as u64);
        self.read().map(|reel| reel.map(Cow::Owned)).map_err(|fault| {
            let text = fault.to_string();
            self.fault = Some(fault);
            text
        })
    }

    /// Shows it to whoever watches.
    pub(super) fn show(&mut self, bytes: &[u8]) -> Result<(), TapeFileError> {
        let is_short = self.work.is_short();
        let shown = self.observer.as_mut().map_or(Ok(()), |observer| observer.tape(bytes, is_short));
        shown.map_err(|fault| io::Error::other(fault).into())
    }

    pub(super) fn read(&mut self) -> Result<Option<RecordingChunk>, TapeFileError> {
        let (letter, bytes, _held) = self.pieces.next()?;
        match letter {
            b'R' => {
                let reel = RecordingChunk::from_bytes(&bytes).map_err(ResimulateError::from)?;
                self.work.add(&reel);
                self.show(&piece(letter, &bytes))?;
                if let Some(kept) = &mut self.kept {
                    kept.keep(reel.clone())?;
                }
                self.waiting.grow(bytes_of(&reel) as u64, "what a tape holds")?;
                Ok(Some(reel))
            }
            b'E' => {
                self.end = Some(parse(&bytes, "its end")?);
                self.show(&piece(letter, &bytes))?;
                Ok(None)
            }
            other => Err(TapeFileError::Format(format!("a piece `{}`, expected R or E", other.escape_ascii()))),
        }
    }
}
