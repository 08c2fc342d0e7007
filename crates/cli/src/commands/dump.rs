//! `--dump`: what a machine can tell beside its picture, as JSON Lines.

use crate::error::{Done, Failure};
use crate::outputs::PartialFile;
use basrelief_session::{FrameLog, MachineConfig, SpanRecord};
use std::fmt::Write as _;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The files of `--dump`.
#[derive(Debug, Default)]
pub struct Dumps {
    spans: Vec<(PathBuf, PartialFile)>,
}

impl Dumps {
    /// Opens what the command line asks for: pairs of what and file.
    ///
    /// # Errors
    /// What no machine tells, or another one does; a file that cannot be written.
    pub fn open(asked: &[PathBuf], config: &MachineConfig) -> Done<Self> {
        let mut dumps = Self::default();
        for [what, path] in asked.as_chunks::<2>().0 {
            if what != Path::new("spans") {
                return Err(Failure::Usage(format!("--dump: there is no `{}` to write; expected spans", what.display())));
            }
            if config.texel_error_bound().is_none() {
                let name = config.machine().name;
                return Err(Failure::Usage(format!("--dump: machine `{name}` has no spans; --machine texel has")));
            }
            dumps.spans.push((path.clone(), PartialFile::create(path).map_err(Failure::file(path, "be written"))?));
        }
        Ok(dumps)
    }

    /// Whether the machine has to keep logs for them.
    pub fn any(&self) -> bool {
        !self.spans.is_empty()
    }

    /// Writes the spans of a frame.
    ///
    /// # Errors
    /// A file that cannot be written, in a sentence.
    pub fn texels(&mut self, index: usize, log: &FrameLog) -> Result<(), String> {
        for (path, file) in &mut self.spans {
            let mut write = || log.spans.iter().try_for_each(|span| file.write_all(line(index, span).as_bytes()));
            write().map_err(|e| format!("{}: cannot be written: {e}", path.display()))?;
        }
        Ok(())
    }

    /// Puts the files in their place.
    pub fn publish(self) -> Done {
        self.spans.into_iter().try_for_each(|(path, file)| file.publish().map_err(Failure::file(&path, "be written")))
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
