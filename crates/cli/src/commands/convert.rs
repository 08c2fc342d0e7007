//! `basrelief convert`: converts a trace between its forms. In another folder it holds its texels itself.

use crate::args::ConvertArgs;
use crate::error::{CommandError, CommandResult};
use crate::input::TraceFile;
use crate::outputs::{PartialFile, check_outputs_keep_inputs};
use basrelief_input::{MemoryPool, open_in_folder};
use basrelief_trace::{self as display_list, TraceForm};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::Path;

/// Converts a trace.
pub fn convert(args: &ConvertArgs, budget: &MemoryPool) -> CommandResult {
    let (input, output) = ([("INPUT", &*args.input)], [("OUTPUT", &*args.output)]);
    check_outputs_keep_inputs(None, &output, &input).map_err(CommandError::Usage)?;
    let input = TraceFile::open(&args.input)?;
    let failed = CommandError::in_input(&input.name);
    let moves = is_elsewhere(&input.folder, &args.output);
    to_trace_file(&args.output, |writer, form| {
        let done = if moves {
            display_list::convert_with_texels(input.reader, writer, form, budget, open_in_folder(&input.folder))
        } else {
            display_list::convert(input.reader, writer, form, budget)
        };
        done.map(|_| ()).map_err(failed)
    })
}

/// Returns true if the files of texels that a trace of this folder names are not found from the output.
fn is_elsewhere(folder: &Path, output: &Path) -> bool {
    let real = |folder: &Path| if folder.as_os_str().is_empty() { Path::new(".") } else { folder }.canonicalize().ok();
    output == Path::new("-") || output.parent().is_none_or(|to| real(to) != real(folder))
}

/// Returns the form that a file name selects.
pub fn form_of(path: &Path) -> CommandResult<TraceForm> {
    let name = path.to_string_lossy();
    if name == "-" {
        return Ok(TraceForm::default());
    }
    TraceForm::for_file_name(&name).ok_or_else(|| {
        CommandError::Usage(format!(
            "{name}: the file name selects the form of a trace; expected .jsonl or .bdl, or either with .zst appended"
        ))
    })
}

/// Writes a trace atomically to a file, or to standard output.
pub fn to_trace_file(path: &Path, write: impl FnOnce(&mut dyn Write, TraceForm) -> CommandResult) -> CommandResult {
    let form = form_of(path)?;
    if path == Path::new("-") {
        let mut out = ErrorKeepingWriter { to: BufWriter::new(io::stdout().lock()), failed: None };
        let done = write(&mut out, form).and_then(|()| out.flush().map_err(CommandError::in_input("standard output")));
        return match out.failed {
            // A closed pipe is no error.
            Some(e) if e.kind() == ErrorKind::BrokenPipe => Ok(()),
            Some(e) => Err(CommandError::BadInput(format!("standard output: cannot be written: {e}"))),
            None => done,
        };
    }
    let file = PartialFile::create(path).map_err(CommandError::at_file(path, "be written"))?;
    let mut file = ErrorKeepingWriter { to: file, failed: None };
    let done = write(&mut file, form);
    match file.failed {
        Some(e) => Err(CommandError::at_file(path, "be written")(e)),
        None => done.and_then(|()| file.to.publish().map_err(CommandError::at_file(path, "be written"))),
    }
}

/// Remembers write errors, which the trace writer would report as errors of its input.
struct ErrorKeepingWriter<W> {
    to: W,
    failed: Option<io::Error>,
}

impl<W> ErrorKeepingWriter<W> {
    fn keep_error<T>(&mut self, done: io::Result<T>) -> io::Result<T> {
        done.inspect_err(|e| {
            if e.kind() != ErrorKind::Interrupted {
                self.failed.get_or_insert_with(|| copy_of(e));
            }
        })
    }
}

/// Copies kind and message of an error.
fn copy_of(error: &io::Error) -> io::Error {
    error.raw_os_error().map_or_else(|| io::Error::new(error.kind(), error.to_string()), io::Error::from_raw_os_error)
}

impl<W: Write> Write for ErrorKeepingWriter<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let done = self.to.write(bytes);
        self.keep_error(done)
    }
    fn flush(&mut self) -> io::Result<()> {
        let done = self.to.flush();
        self.keep_error(done)
    }
}
