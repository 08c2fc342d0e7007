//! Reads a trace of any form as a stream of commands.

use crate::check::{check, check_version};
use crate::command::{BeginCommand, TraceCommand};
use crate::error::{CommandFault, ErrorKind, TraceError, TracePlace};
use crate::form::{BINARY_MAGIC, TraceBytes, TraceEncoding};
use crate::sequence::CommandOrder;
use basrelief_input::{JsonFault, MemoryPool, MemoryReservation, OverBudget, json_weight};
use serde::Deserialize;
use std::io::{self, BufRead, Read};

/// Longest line or record \[bytes\], but for textures.
const LIMIT: u64 = 16 << 20;
/// Longest line or record of a texture \[bytes\].
const TEXTURE_LIMIT: u64 = 512 << 20;
/// Lines and records up to this length \[bytes\] are not counted, because there is one at a time.
const SMALL: usize = 1 << 16;
/// Largest growth of a record in memory \[times\], reached by a list of switches in an expectation.
const GROWTH: u64 = 32;

/// Stream of commands, `begin` and `end` included. Each command has passed its checks (finite numbers, ranges, lengths).
/// `begin` is the first command and `end`, with the right count, the last. A trace without `end` is an error. After an error
/// the iterator ends.
///
/// One command is in memory at a time. Allocations follow the bytes that arrive and not the sizes that a file declares. A
/// command is counted against the memory limit until the next one is requested.
pub struct TraceReader<R: Read> {
    source: TraceBytes<R>,
    encoding: TraceEncoding,
    order: CommandOrder,
    begin: BeginCommand,
    given_begin: bool,
    failed: bool,
    buffer: Vec<u8>,
    /// Reservation of the buffer and the last command.
    held: MemoryReservation,
    /// Reservation of the decompressor.
    _window: MemoryReservation,
}

/// Opens a trace of any form, recognised by its first bytes, and reads its `begin`.
///
/// # Errors
/// If the input cannot be read, is no display list, has another version, or exceeds the memory limit.
pub fn open<R: Read>(reader: R, budget: &MemoryPool) -> Result<TraceReader<R>, TraceError> {
    let (head, source, window) = TraceBytes::open(reader, budget).map_err(|e| open_error(&e))?;
    let encoding = if head.starts_with(&BINARY_MAGIC) { TraceEncoding::Binary } else { TraceEncoding::JsonLines };
    if encoding == TraceEncoding::JsonLines && !head.is_empty() && !head.starts_with(b"{") {
        let message = if head.starts_with(b"glTF") {
            "a binary glTF model, expected a display list; save the model as a file, and name that file"
        } else {
            r#"no display list: expected JSON Lines that open with {"begin", their binary twin, or either in zstd"#
        };
        return Err(TraceError::new(TracePlace::Start, ErrorKind::Malformed, "", message));
    }
    let mut reader = TraceReader {
        source,
        encoding,
        order: CommandOrder::default(),
        begin: BeginCommand::new(1, 1),
        given_begin: false,
        failed: false,
        buffer: Vec::new(),
        held: budget.empty_reservation(),
        _window: window,
    };
    if encoding == TraceEncoding::Binary {
        reader.read_header()?;
    }
    reader.begin = match reader.command()? {
        TraceCommand::Begin(begin) => begin,
        other => return Err(CommandFault::new("", "stands first; expected `begin`").at(reader.place(), other.name())),
    };
    Ok(reader)
}

fn open_error(error: &io::Error) -> TraceError {
    if error.kind() == io::ErrorKind::Unsupported {
        return TraceError::new(TracePlace::Start, ErrorKind::Unsupported, "", error.to_string());
    }
    TraceError::read(TracePlace::Start, error)
}

impl<R: Read> TraceReader<R> {
    /// The first command.
    pub fn begin(&self) -> &BeginCommand {
        &self.begin
    }

    /// Place of the last command, or of the command that is being read.
    pub(crate) fn place(&self) -> TracePlace {
        self.place_of(self.order.count().max(1))
    }

    /// Counted bytes of the last command.
    pub(crate) fn held(&self) -> u64 {
        self.held.bytes()
    }

    /// Error of a request beyond the memory limit, at the last command.
    pub(crate) fn over_budget(&self, error: &OverBudget) -> TraceError {
        TraceError::over_budget(self.place(), error)
    }

    fn next_place(&self) -> TracePlace {
        self.place_of(self.order.count() + 1)
    }

    fn place_of(&self, number: u64) -> TracePlace {
        match self.encoding {
            TraceEncoding::JsonLines => TracePlace::Line { line: number, column: None },
            TraceEncoding::Binary => TracePlace::Record(number),
        }
    }

    fn read_header(&mut self) -> Result<(), TraceError> {
        self.fill(BINARY_MAGIC.len() as u64 + 4)?;
        let version = self.buffer.last_chunk().copied().map_or(0, u32::from_le_bytes);
        check_version(version).map_err(|fault| fault.at(TracePlace::Start, "begin"))
    }

    fn command(&mut self) -> Result<TraceCommand, TraceError> {
        self.held.shrink_to(0);
        let command = match self.encoding {
            TraceEncoding::JsonLines => self.line()?,
            TraceEncoding::Binary => self.record()?,
        };
        if self.buffer.capacity() > SMALL {
            self.held.give_back(self.buffer.capacity() as u64);
            self.buffer = Vec::new();
        }
        let place = self.next_place();
        self.order.accept(&command).and_then(|()| check(&command)).map_err(|fault| fault.at(place, command.name()))?;
        if self.order.ended() {
            self.expect_nothing()?;
        }
        Ok(command)
    }

    fn line(&mut self) -> Result<TraceCommand, TraceError> {
        self.buffer.clear();
        let mut most = SMALL as u64;
        loop {
            self.line_up_to(most)?;
            let texture = self.buffer.starts_with(br#"{"texture""#);
            if self.buffer.ends_with(b"\n") || (self.buffer.len() as u64) < most || most == limit(texture) {
                break;
            }
            most = (2 * most).min(limit(texture));
        }
        let ended = self.buffer.pop_if(|last| *last == b'\n').is_some();
        if !ended && (self.buffer.is_empty() || self.buffer.len() as u64 >= LIMIT) {
            return Err(self.unfinished_line());
        }
        if self.buffer.len() > SMALL {
            self.hold(json_weight(&self.buffer), "the values of a line")?;
        }
        // The last line may lack its line end. It is whole if its JSON is.
        let fault = |fault| if ended { self.line_error(&fault) } else { self.unfinished_line() };
        basrelief_input::from_slice(&self.buffer).map_err(fault)
    }

    /// Fills the buffer up to this length, or to the end of the line.
    fn line_up_to(&mut self, length: u64) -> Result<(), TraceError> {
        let place = self.next_place();
        self.room(length)?;
        let mut source = self.source.by_ref().take(length - self.buffer.len() as u64);
        source.read_until(b'\n', &mut self.buffer).map_err(|e| TraceError::read(place, &e)).map(drop)
    }

    /// Makes room in the buffer, which is counted from [`SMALL`] on.
    fn room(&mut self, length: u64) -> Result<(), TraceError> {
        let more = length.saturating_sub(self.buffer.capacity().max(SMALL) as u64);
        if more > 0 {
            let whole = if self.buffer.capacity() <= SMALL { length } else { more };
            self.hold(whole, "a line or record")?;
            self.buffer.reserve_exact(length as usize - self.buffer.len());
        }
        Ok(())
    }

    fn hold(&mut self, bytes: u64, what: &str) -> Result<(), TraceError> {
        let place = self.next_place();
        self.held.try_grow(bytes, what).map_err(|error| TraceError::over_budget(place, &error))
    }

    fn unfinished_line(&self) -> TraceError {
        let place = self.next_place();
        match self.buffer.len() as u64 {
            0 => TraceError::truncated(place, "expected a command, at the latest `end`"),
            LIMIT | TEXTURE_LIMIT => too_long(place, self.buffer.len() as u64),
            _ => TraceError::truncated(place, "the last line is incomplete"),
        }
    }

    fn line_error(&self, fault: &JsonFault) -> TraceError {
        let place = self.next_place();
        if self.order.count() == 0
            && let Some(fault) = other_version(&self.buffer)
        {
            return fault.at(place, "begin");
        }
        if self.buffer.trim_ascii().is_empty() {
            return TraceError::new(
                place,
                ErrorKind::Malformed,
                String::new(),
                "the line is blank, expected a command: delete it",
            );
        }
        let at = match place {
            TracePlace::Line { line, .. } => TracePlace::Line { line, column: Some(fault.column) },
            other => other,
        };
        let message = fault.message.as_str();
        if let (0..=1, Some(unknown)) = (fault.path.0.len(), message.strip_prefix("unknown value")) {
            return TraceError::new(at, ErrorKind::Malformed, String::new(), format!("unknown command{unknown}"));
        }
        let path = if fault.path.0.is_empty() { String::new() } else { fault.path.to_string() };
        TraceError::new(at, ErrorKind::Malformed, path, message)
    }

    fn record(&mut self) -> Result<TraceCommand, TraceError> {
        let place = self.next_place();
        self.fill(4)?;
        let length = self.buffer.last_chunk().copied().map_or(0, u32::from_le_bytes);
        let first = self.source.fill_buf().map_err(|e| TraceError::read(place, &e))?.first().copied();
        let name = first.and_then(|number| TraceCommand::NAMES.get(usize::from(number)));
        if u64::from(length) > limit(name == Some(&"texture")) {
            return Err(too_long(place, u64::from(length)));
        }
        self.fill(u64::from(length))?;
        if self.buffer.len() > SMALL {
            let growth = if name == Some(&"texture") { 1 } else { GROWTH };
            self.hold(growth * u64::from(length), "the values of a record")?;
        }
        let malformed = |what: String| {
            let message = format!("not a valid record ({what}): the file is damaged, or not of this version");
            TraceError::new(place, ErrorKind::Malformed, name.copied().unwrap_or("unknown command"), message)
        };
        // Older records of objects end ahead of the field `mesh`, or of its digest. They are read as if it was empty, or 0.
        let spare = usize::from(name == Some(&"object"));
        self.buffer.resize(self.buffer.len() + spare, 0);
        match postcard::take_from_bytes(&self.buffer) {
            Ok((_, rest)) if rest.len() > spare => Err(malformed(format!("{} bytes too many", rest.len() - spare))),
            Ok((command, _)) => Ok(command),
            Err(error) => Err(malformed(error.to_string())),
        }
    }

    /// Fills the buffer with exactly this many bytes. It grows as bytes arrive, because the count is untrusted.
    fn fill(&mut self, bytes: u64) -> Result<(), TraceError> {
        let place = self.next_place();
        self.buffer.clear();
        let (mut most, mut got) = (bytes.min(SMALL as u64), 0);
        loop {
            self.room(most)?;
            let mut source = self.source.by_ref().take(most - got);
            got += source.read_to_end(&mut self.buffer).map_err(|e| TraceError::read(place, &e))? as u64;
            if got < most || most == bytes {
                break;
            }
            most = (2 * most).min(bytes);
        }
        match got {
            got if got == bytes => Ok(()),
            0 => Err(TraceError::truncated(place, "expected a command, at the latest `end`")),
            got => Err(TraceError::truncated(place, &format!("{got} of {bytes} bytes are there"))),
        }
    }

    fn expect_nothing(&mut self) -> Result<(), TraceError> {
        let place = self.next_place();
        loop {
            let rest = self.source.fill_buf().map_err(|e| TraceError::read(place, &e))?;
            // Blank lines behind the last command are skipped.
            let blank = if self.encoding == TraceEncoding::JsonLines { rest.trim_ascii().is_empty() } else { rest.is_empty() };
            match rest.len() {
                0 => return Ok(()),
                length if blank => self.source.consume(length),
                _ => break,
            }
        }
        Err(TraceError::new(place, ErrorKind::Malformed, "", "something stands after `end`; nothing may follow it"))
    }
}

impl<R: Read> Iterator for TraceReader<R> {
    type Item = Result<TraceCommand, TraceError>;

    fn next(&mut self) -> Option<Self::Item> {
        if !self.given_begin {
            self.given_begin = true;
            return Some(Ok(TraceCommand::Begin(self.begin.clone())));
        }
        if self.failed || self.order.ended() {
            return None;
        }
        let command = self.command();
        self.failed = command.is_err();
        Some(command)
    }
}

/// Longest line or record \[bytes\].
pub(crate) fn limit(texture: bool) -> u64 {
    if texture { TEXTURE_LIMIT } else { LIMIT }
}

pub(crate) fn too_long(place: TracePlace, bytes: u64) -> TraceError {
    let message = format!(
        "{bytes} bytes or more in one command, expected at most {} MiB for a texture and {} MiB for others: \
         put large texels into a `file` beside the trace",
        TEXTURE_LIMIT >> 20,
        LIMIT >> 20
    );
    TraceError::new(place, ErrorKind::Malformed, "", message)
}

/// Fault of a `begin` of another version. Its fields may differ, too, so the version is reported first.
fn other_version(line: &[u8]) -> Option<CommandFault> {
    #[derive(Deserialize)]
    struct VersionProbe {
        begin: Version,
    }
    #[derive(Deserialize)]
    struct Version {
        version: u32,
    }
    let probe: VersionProbe = serde_json::from_slice(line).ok()?;
    check_version(probe.begin.version).err()
}
