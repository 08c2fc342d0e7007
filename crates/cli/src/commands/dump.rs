//! `--dump`: what a machine can tell beside its picture, as JSON Lines.

use crate::error::{Done, Failure};
use crate::outputs::PartialFile;
use basrelief_session::{Exhibit, FrameLog, MachineConfig, SpanRecord, dump};
use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// What can be written, and the machine that keeps it.
const KINDS: [(&str, &str); 3] = [("spans", "texel"), ("reference-buffer", "defer"), ("tiles", "defer")];

/// A file of lines that is being written.
#[derive(Debug)]
struct Dump {
    what: &'static str,
    path: PathBuf,
    file: PartialFile,
}

/// The files of `--dump`.
#[derive(Debug, Default)]
pub struct Dumps(Vec<Dump>);

impl Dumps {
    /// Opens what the command line asks for: pairs of what and file.
    ///
    /// # Errors
    /// What no machine tells, or another one does; a file that cannot be written.
    pub fn open(asked: &[PathBuf], config: &MachineConfig) -> Done<Self> {
        let open = |[what, path]: &[PathBuf; 2]| {
            let what = known(what, config.machine().name).map_err(Failure::Usage)?;
            let file = PartialFile::create(path).map_err(Failure::file(path, "be written"))?;
            Ok(Dump { what, path: path.clone(), file })
        };
        let pairs = asked.as_chunks::<2>().0;
        pairs.iter().try_for_each(|[_, path]| is_file(path)).map_err(Failure::Usage)?;
        pairs.iter().map(open).collect::<Done<_>>().map(Self)
    }

    /// Whether the machine has to keep logs for them.
    pub fn any(&self) -> bool {
        !self.0.is_empty()
    }

    /// Writes lines into the files of this kind.
    fn write(&mut self, kind: &str, lines: impl Fn(&mut PartialFile) -> io::Result<()>) -> Result<(), String> {
        let mut wanted = self.0.iter_mut().filter(|dump| dump.what == kind);
        wanted.try_for_each(|d| lines(&mut d.file).map_err(|e| format!("{}: cannot be written: {e}", d.path.display())))
    }

    /// Writes the spans of a frame.
    ///
    /// # Errors
    /// A file that cannot be written, in a sentence.
    pub fn texels(&mut self, index: usize, log: &FrameLog) -> Result<(), String> {
        self.write("spans", |file| log.spans.iter().try_for_each(|span| file.write_all(line(index, span).as_bytes())))
    }

    /// Writes the lines of an exhibit.
    ///
    /// # Errors
    /// As above.
    pub fn exhibit(&mut self, exhibit: &Exhibit) -> Result<(), String> {
        match exhibit {
            Exhibit::ReferenceBuffer(filled) => self.write("reference-buffer", |file| dump::write_reference_buffer(filled, file)),
            Exhibit::Tiles { frame, tiles } => self.write("tiles", |file| dump::write_tiles(*frame, tiles, file)),
            Exhibit::Round(_) | Exhibit::TileLists(_) => Ok(()),
        }
    }

    /// Writes out what is still held: what cannot be written is known before anything is in its place.
    pub fn flush(&mut self) -> Done {
        self.0.iter_mut().try_for_each(|d| d.file.flush().map_err(Failure::file(&d.path, "be written")))
    }

    /// Puts the files in their place.
    pub fn publish(self) -> Done {
        self.0.into_iter().try_for_each(|d| d.file.publish().map_err(Failure::file(&d.path, "be written")))
    }
}

fn is_file(path: &Path) -> Result<(), String> {
    if path.as_os_str() == "-" {
        return Err("--dump: standard output is the report's; expected a file, `./-` where it is to be called `-`".into());
    }
    Ok(())
}

/// The name as it stands in [`KINDS`].
fn known(what: &Path, machine: &str) -> Result<&'static str, String> {
    match KINDS.iter().find(|kind| Path::new(kind.0) == what) {
        None => {
            let names: Vec<&str> = KINDS.iter().map(|kind| kind.0).collect();
            Err(format!("--dump: there is no `{}` to write; expected {}", what.display(), names.join(", ")))
        }
        Some((name, of)) if *of != machine => Err(format!("--dump: machine `{machine}` has no {name}; --machine {of} has")),
        Some((name, _)) => Ok(name),
    }
}

/// A span as an object; of frames behind the first it begins with their number.
fn line(index: usize, span: &SpanRecord) -> String {
    let mut divisions = span.divisions.clone();
    divisions.sort_unstable();
    let mut text = String::from("{");
    // Formatting into a string cannot fail.
    if index > 0 {
        let _ = write!(text, "\"frame\": {index}, ");
    }
    let SpanRecord { y, x: [left, right], w: [w_left, w_right], .. } = span;
    let _ = write!(text, "\"y\": {y}, \"x\": [{left}, {right}], \"w\": [{w_left}, {w_right}], \"divisions\": {divisions:?}}}");
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dump_that_the_machine_does_not_have_is_refused_with_the_machine_that_has_it() {
        assert_eq!(known(Path::new("tiles"), "defer"), Ok("tiles"));
        assert!(known(Path::new("tiles"), "bump").unwrap_err().contains("--machine defer has"));
        assert!(known(Path::new("tile"), "defer").unwrap_err().contains("expected spans, reference-buffer, tiles"));
    }

    #[test]
    fn standard_output_is_no_dump() {
        assert_eq!(is_file(Path::new("./-")), Ok(()));
        assert!(is_file(Path::new("-")).unwrap_err().contains("expected a file"));
    }

    #[test]
    fn a_span_is_one_line_with_its_division_points_from_left_to_right() {
        let span = SpanRecord { y: 12, x: [3, 90], w: [0.25, 1.0 / 3.0], divisions: vec![60, 9, 25] };
        let expected = "{\"y\": 12, \"x\": [3, 90], \"w\": [0.25, 0.3333333333333333], \"divisions\": [9, 25, 60]}\n";
        assert_eq!(line(0, &span), expected);
        let none = SpanRecord { divisions: vec![], ..span };
        assert!(line(2, &none).starts_with("{\"frame\": 2, \"y\": 12, ") && line(2, &none).ends_with("\"divisions\": []}\n"));
        let read: serde_json::Value = serde_json::from_str(&line(1, &none)).unwrap();
        assert_eq!(read["w"][1].as_f64(), Some(1.0 / 3.0), "to the bit");
    }
}
