//! Reader of recordings, block by block.

use super::error::RecordingError;
use super::format::{
    FIRST_LINE, MAX_BLOCK_BYTES, RecordingEnd, RecordingHeader, RecordingSeal, SEAL_BYTES, WorkHash, block, sealed_end,
    work_bytes,
};
use super::kept::KeptSteps;
use crate::build::BUILD;
use crate::observer::Observer;
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_kernel::ResimulateError;
use basrelief_kernel::recording::RecordingChunk;
use basrelief_machines::MachineInfo;
use serde::Deserialize;
use std::borrow::Cow;
use std::io::{self, Read};

/// Returns true if a decompressed stream begins like a recording.
pub fn looks_like_recording(reader: impl Read) -> bool {
    let mut first = Vec::new();
    reader.take(FIRST_LINE.len() as u64).read_to_end(&mut first).is_ok() && first == FIRST_LINE
}

/// Blocks of a recording.
pub(super) struct BlockReader<'a> {
    reader: &'a mut dyn Read,
    budget: &'a MemoryPool,
    /// Seal of the header, once that is read.
    seal: Option<RecordingSeal>,
    /// True if this build wrote the recording, which therefore ends with its seal.
    is_of_this_build: bool,
}

impl<'a> BlockReader<'a> {
    pub(super) fn new(reader: &'a mut dyn Read, budget: &'a MemoryPool) -> Self {
        Self { reader, budget, seal: None, is_of_this_build: false }
    }

    /// Reads the header, and finds its machine.
    pub(super) fn header(&mut self) -> Result<(RecordingHeader, &'static MachineInfo), RecordingError> {
        let mut first = [0; FIRST_LINE.len()];
        self.fill(&mut first)?;
        if first != FIRST_LINE {
            return Err(RecordingError::Format("it does not begin with `basrelief-tape/1`".into()));
        }
        let (b'H', content, _held) = self.next()? else { return Err(RecordingError::Format("it has no header".into())) };
        let header: RecordingHeader = parse(&content, "header")?;
        let machine = MachineInfo::named(&header.machine).map_err(RecordingError::Format)?;
        self.seal = Some(RecordingSeal::of_header(&content));
        self.is_of_this_build = header.build == BUILD;
        Ok((header, machine))
    }

    /// Reads the letter and the content of the next block.
    fn next(&mut self) -> Result<(u8, Vec<u8>, MemoryReservation), RecordingError> {
        let mut start = [0; 5];
        self.fill(&mut start)?;
        let [letter, length @ ..] = start;
        let length = u32::from_le_bytes(length);
        if length > MAX_BLOCK_BYTES {
            return Err(RecordingError::Format(format!("a block of {length} bytes, expected at most {MAX_BLOCK_BYTES}")));
        }
        // The vector grows with the bytes read, so that a wrong length alone allocates no memory.
        let held = self.budget.try_reserve(length.into(), "a block of a recording")?;
        let mut content = Vec::new();
        self.reader.take(length.into()).read_to_end(&mut content)?;
        if content.len() < length as usize {
            return Err(RecordingError::Format("it is truncated within a block".into()));
        }
        Ok((letter, content, held))
    }

    /// Checks the seal behind the block `E` of this content, and that nothing follows. Only a read to the end of a compressed file checks
    /// the checksum of the compression.
    fn check_seal(&mut self, end: &[u8]) -> Result<(), RecordingError> {
        let format = |text: &str| Err(RecordingError::Format(text.into()));
        let mut rest = Vec::new();
        let longest = (1 + size_of::<u32>() + SEAL_BYTES + 1) as u64;
        self.reader.take(longest).read_to_end(&mut rest)?;
        let seal = self.seal.take().map(|seal| block(b'S', &seal.close(end))).unwrap_or_default();
        match &rest[..] {
            [] if !self.is_of_this_build => Ok(()),
            rest if rest == seal => Ok(()),
            rest if rest.starts_with(&seal) => format("more data follow its end"),
            rest if seal.starts_with(rest) => format("it is truncated behind its result"),
            _ => format("the SHA-256 of its header and result is not the one that it states"),
        }
    }

    fn fill(&mut self, bytes: &mut [u8]) -> Result<(), RecordingError> {
        self.reader.read_exact(bytes).map_err(|error| match error.kind() {
            io::ErrorKind::UnexpectedEof => RecordingError::Format("it is truncated".into()),
            _ => error.into(),
        })
    }
}

fn parse<T: for<'de> Deserialize<'de>>(content: &[u8], name: &str) -> Result<T, RecordingError> {
    basrelief_input::from_slice(content)
        .map_err(|fault| RecordingError::Format(format!("{name}: at `{}`: {}", fault.path, fault.message)))
}

/// Chunks of steps of a recording, read on demand.
pub(super) struct ChunkReader<'a> {
    blocks: BlockReader<'a>,
    /// Observer that receives a copy of the recording.
    observer: Option<&'a mut dyn Observer>,
    /// Seal of the header of that copy.
    copy_seal: Option<RecordingSeal>,
    pub(super) work: WorkHash,
    /// Steps kept for bottleneck analysis.
    pub(super) kept: Option<KeptSteps>,
    pub(super) end: Option<RecordingEnd>,
    pub(super) error: Option<RecordingError>,
    /// Memory of steps that are read but not yet timed.
    pub(super) waiting: MemoryReservation,
}

impl<'a> ChunkReader<'a> {
    pub(super) fn new(blocks: BlockReader<'a>, observer: Option<&'a mut dyn Observer>, kept: Option<KeptSteps>) -> Self {
        let waiting = blocks.budget.empty_reservation();
        Self { blocks, observer, copy_seal: None, work: WorkHash::default(), kept, end: None, error: None, waiting }
    }

    /// Returns the next chunk to the kernel, which still has `waiting` bytes of previous chunks. The kernel receives only the text of an
    /// error; the error itself is kept in `self.error`.
    pub(super) fn next(&mut self, waiting: usize) -> Result<Option<Cow<'static, RecordingChunk>>, String> {
        if self.end.is_some() || self.error.is_some() {
            return Ok(None);
        }
        self.waiting.shrink_to(waiting as u64);
        self.read().map(|chunk| chunk.map(Cow::Owned)).map_err(|error| {
            let text = error.to_string();
            self.error = Some(error);
            text
        })
    }

    /// Passes the header of the copy to the observer.
    pub(super) fn begin_copy(&mut self, (header, seal): (Vec<u8>, RecordingSeal)) -> Result<(), RecordingError> {
        self.copy_seal = Some(seal);
        self.pass_on_to_observer(&header)
    }

    /// Passes bytes of the recording to the observer.
    fn pass_on_to_observer(&mut self, bytes: &[u8]) -> Result<(), RecordingError> {
        let is_short = self.work.is_short();
        let shown = self.observer.as_mut().map_or(Ok(()), |observer| observer.recording(bytes, is_short));
        shown.map_err(|error| io::Error::other(error).into())
    }

    /// Reads the next chunk; `None` at the end.
    pub(super) fn read(&mut self) -> Result<Option<RecordingChunk>, RecordingError> {
        let (letter, content, _held) = self.blocks.next()?;
        match letter {
            b'R' => {
                let chunk = RecordingChunk::from_bytes(&content).map_err(ResimulateError::from)?;
                self.work.add(&chunk);
                self.pass_on_to_observer(&block(letter, &content))?;
                if let Some(kept) = &mut self.kept {
                    kept.keep(chunk.clone())?;
                }
                self.waiting.try_grow(work_bytes(&chunk) as u64, "the steps of a recording")?;
                Ok(Some(chunk))
            }
            b'E' => {
                self.end = Some(parse(&content, "end")?);
                self.blocks.check_seal(&content)?;
                if let Some(seal) = self.copy_seal.take() {
                    self.pass_on_to_observer(&sealed_end(&content, seal))?;
                }
                Ok(None)
            }
            other => Err(RecordingError::Format(format!("a block `{}`, expected R or E", other.escape_ascii()))),
        }
    }
}

/// Returns the end of a recording if its SHA-256 is that of the work that was read.
pub(super) fn checked_end(end: Option<RecordingEnd>, work: WorkHash) -> Result<RecordingEnd, RecordingError> {
    match end {
        None => Err(RecordingError::Format("it has no end".into())),
        Some(end) if work.finish() == end.work => Ok(end),
        Some(_) => Err(RecordingError::Format("the SHA-256 of its work is not the one that it states".into())),
    }
}
