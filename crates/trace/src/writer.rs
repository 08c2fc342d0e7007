//! Writes a stream of commands in any form.

use crate::Texels;
use crate::check::check;
use crate::command::{EndCommand, TraceCommand, VERSION};
use crate::error::{CommandFault, ErrorKind, TraceError, TracePlace};
use crate::form::{BINARY_MAGIC, ByteSink, TraceEncoding, TraceForm};
use crate::reader::{limit, open, too_long};
use crate::resolver::{TextureFiles, texels_of_file};
use crate::sequence::CommandOrder;
use basrelief_input::{MemoryPool, MemoryReservation};
use std::io::{self, Read, Write};

/// Writes commands. Each command passes the checks of the reader, so that the output can be read.
pub struct TraceWriter<W: Write> {
    sink: ByteSink<W>,
    encoding: TraceEncoding,
    order: CommandOrder,
    buffer: Vec<u8>,
}

impl<W: Write> TraceWriter<W> {
    /// A writer of this form. Output is buffered; call [`TraceWriter::finish`] at the end.
    ///
    /// # Errors
    /// If `writer` fails, or the form is compressed and this build has no zstd.
    pub fn new(writer: W, form: TraceForm) -> Result<Self, TraceError> {
        let start = |e: io::Error| {
            let kind = if e.kind() == io::ErrorKind::Unsupported { ErrorKind::Unsupported } else { ErrorKind::Io };
            TraceError::new(TracePlace::Start, kind, "", format!("cannot write: {e}"))
        };
        let mut sink = ByteSink::create(writer, form.compressed).map_err(start)?;
        if form.encoding == TraceEncoding::Binary {
            sink.write_all(&BINARY_MAGIC).map_err(start)?;
            sink.write_all(&VERSION.to_le_bytes()).map_err(start)?;
        }
        Ok(Self { sink, encoding: form.encoding, order: CommandOrder::default(), buffer: Vec::new() })
    }

    /// Writes a command: first `begin`.
    ///
    /// # Errors
    /// A command out of order, a value that is not allowed, or a failed write.
    pub fn write(&mut self, command: &TraceCommand) -> Result<(), TraceError> {
        let place = TracePlace::Command(self.order.count() + 1);
        let checked = check(command).and_then(|()| self.order.accept(command));
        checked.map_err(|fault| fault.at(place, command.name()))?;
        self.buffer.clear();
        match self.encoding {
            TraceEncoding::JsonLines => write_line(command, &mut self.buffer).map_err(|e| TraceError::write(place, &e))?,
            TraceEncoding::Binary => self.encode(command, place)?,
        }
        let bytes = self.buffer.len() as u64;
        if bytes > limit(matches!(command, TraceCommand::Texture(_))) {
            return Err(too_long(place, bytes));
        }
        self.sink.write_all(&self.buffer).map_err(|e| TraceError::write(place, &e))
    }

    fn encode(&mut self, command: &TraceCommand, place: TracePlace) -> Result<(), TraceError> {
        let failed = |what: String| TraceError::new(place, ErrorKind::Io, command.name(), format!("cannot write: {what}"));
        self.buffer.extend([0; 4]);
        self.buffer = postcard::to_extend(command, std::mem::take(&mut self.buffer)).map_err(|e| failed(e.to_string()))?;
        let length = u32::try_from(self.buffer.len() - 4).map_err(|_| failed("longer than 4 GiB".into()))?;
        if let Some(head) = self.buffer.first_chunk_mut() {
            *head = length.to_le_bytes();
        }
        Ok(())
    }

    /// Commands written so far.
    pub fn count(&self) -> u64 {
        self.order.count()
    }

    /// Writes `end`, unless it was written, and all that is buffered; gives the writer back.
    ///
    /// # Errors
    /// If no command was written, or the writer below fails.
    pub fn finish(mut self) -> Result<W, TraceError> {
        if !self.order.ended() {
            self.write(&TraceCommand::End(EndCommand { commands: self.count() }))?;
        }
        let place = TracePlace::Command(self.count());
        self.sink.finish().map_err(|e| TraceError::write(place, &e))
    }
}

/// The canonical line of a command, with its line end.
pub(crate) fn write_line(command: &TraceCommand, mut line: impl Write) -> io::Result<()> {
    serde_json::to_writer(&mut line, command)?;
    line.write_all(b"\n")
}

/// Converts a trace to another form without loss. JSON Lines are canonical: no spaces, fields in a fixed order, no optional
/// fields with their default, shortest decimals. Returns the number of commands.
///
/// # Errors
/// If the trace is malformed or truncated, exceeds the memory limit, or reading or writing fails.
pub fn convert<R: Read, W: Write>(reader: R, writer: W, form: TraceForm, budget: &MemoryPool) -> Result<u64, TraceError> {
    convert_with(reader, writer, form, budget, &mut |_| Ok(None))
}

/// As [`convert`], for a trace that moves away from its `files` of texels: it then holds these texels itself.
///
/// # Errors
/// Those of [`convert`], and a file of texels that cannot be read or has another length.
pub fn convert_with_texels<R: Read, W: Write>(
    reader: R,
    writer: W,
    form: TraceForm,
    budget: &MemoryPool,
    mut files: impl TextureFiles,
) -> Result<u64, TraceError> {
    convert_with(reader, writer, form, budget, &mut |command| {
        let TraceCommand::Texture(definition) = command else { return Ok(None) };
        if definition.file.is_none() {
            return Ok(None);
        }
        let (texels, held) = texels_of_file(definition, &mut files, budget)?;
        (definition.data, definition.file) = (Some(Texels(texels)), None);
        Ok(Some(held))
    })
}

/// Converts a trace after a change of each command. The change returns the reservation of its memory.
fn convert_with<R: Read, W: Write>(
    reader: R,
    writer: W,
    form: TraceForm,
    budget: &MemoryPool,
    change: &mut dyn FnMut(&mut TraceCommand) -> Result<Option<MemoryReservation>, CommandFault>,
) -> Result<u64, TraceError> {
    let mut out = TraceWriter::new(writer, form)?;
    let mut commands = open(reader, budget)?;
    // The line or record of a command counts twice, because it is written from memory.
    let mut written = budget.empty_reservation();
    while let Some(mut command) = commands.next().transpose()? {
        let name = command.name();
        let _held = change(&mut command).map_err(|fault| fault.at(commands.place(), name))?;
        written.shrink_to(0);
        written.try_grow(commands.held(), "a command").map_err(|e| commands.over_budget(&e))?;
        out.write(&command)?;
    }
    let count = out.count();
    out.finish().map(|_| count)
}
