//! `basrelief convert`: any form of a display list into any other.

use crate::args::ConvertArgs;
use crate::error::{Done, Failure};
use crate::input::TraceFile;
use crate::outputs::PartialFile;
use basrelief_display_list::{self as display_list, Form};
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Converts without loss.
pub fn convert(args: &ConvertArgs) -> Done {
    let input = TraceFile::open(&args.input)?;
    let failed = Failure::within(&input.name);
    to_trace_file(&args.output, |writer, form| display_list::convert(input.reader, writer, form).map(|_| ()).map_err(failed))
}

/// The form that a file's name asks for.
pub fn form_of(path: &Path) -> Done<Form> {
    let name = path.to_string_lossy();
    if name == "-" {
        return Ok(Form::default());
    }
    Form::for_file_name(&name).ok_or_else(|| {
        Failure::Usage(format!(
            "{name}: the name tells the form of a display list: expected .jsonl or .bdl, or either with .zst behind"
        ))
    })
}

/// Writes a display list to a file, whole or not at all, or to standard output.
pub fn to_trace_file(path: &Path, write: impl FnOnce(&mut dyn Write, Form) -> Done) -> Done {
    let form = form_of(path)?;
    if path == Path::new("-") {
        let mut out = BufWriter::new(io::stdout().lock());
        write(&mut out, form)?;
        return out.flush().map_err(Failure::file(path, "write"));
    }
    let mut file = PartialFile::create(path).map_err(Failure::file(path, "be written"))?;
    write(&mut file, form)?;
    file.publish().map_err(Failure::file(path, "be written"))
}
