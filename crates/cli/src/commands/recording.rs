//! Files of recordings: `--recording`, the recording beside a report, and recordings to read.

use crate::error::{CommandError, CommandResult};
use crate::outputs::{OutputFolder, PartialFile, RUN_RECORDING, recording_in};
use basrelief_sim::{AnalysisPolicy, Observer, RecordingError};
use basrelief_trace::checked_encoder;
use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// The file of `--recording`, compressed with zstd.
pub struct RecordingFile {
    path: PathBuf,
    encoder: zstd::Encoder<'static, PartialFile>,
}

impl RecordingFile {
    /// Creates the file.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn open(path: &Path) -> CommandResult<Self> {
        let failed = || CommandError::at_file(path, "be written");
        let file = PartialFile::create(path).map_err(failed())?;
        Ok(Self { path: path.into(), encoder: checked_encoder(file).map_err(failed())? })
    }

    /// Appends bytes.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), String> {
        self.encoder.write_all(bytes).map_err(|e| format!("{}: cannot be written: {e}", self.path.display()))
    }

    /// Completes the file for publication.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(self) -> CommandResult<PartialFile> {
        let mut file = self.encoder.finish().map_err(CommandError::at_file(&self.path, "be written"))?;
        file.flush().map_err(CommandError::at_file(&self.path, "be written"))?;
        Ok(file)
    }
}

/// The recording beside a report. It is written only if it is short, and stays in memory, compressed, until the run ends.
pub struct ShortRecording {
    /// `None` if no recording is wanted, or once it is too long.
    encoder: Option<zstd::Encoder<'static, Vec<u8>>>,
}

impl ShortRecording {
    /// Makes an empty recording of a run with this analysis policy.
    pub fn new(limits: AnalysisPolicy) -> CommandResult<Self> {
        let encoder = (limits != AnalysisPolicy::Never).then(|| checked_encoder(Vec::new())).transpose();
        Ok(Self { encoder: encoder.map_err(CommandError::bad_input)? })
    }

    /// Writes the recording beside the report. Returns false if there is none.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write_to(self, outputs: &OutputFolder) -> io::Result<bool> {
        let Some(encoder) = self.encoder else { return Ok(false) };
        let mut file = outputs.create(RUN_RECORDING)?;
        file.write_all(&encoder.finish()?).and_then(|()| file.flush()).map(|()| true)
    }
}

impl Observer for ShortRecording {
    fn recording(&mut self, bytes: &[u8], is_short: bool) -> Result<(), String> {
        self.encoder = self.encoder.take().filter(|_| is_short);
        self.encoder.as_mut().map_or(Ok(()), |encoder| encoder.write_all(bytes)).map_err(|e| e.to_string())
    }
}

/// Returns the recording that `path` names: the file itself, or the recording in a folder.
pub fn place_of(path: &Path) -> PathBuf {
    if path.is_dir() { recording_in(path) } else { path.to_path_buf() }
}

/// Message about a folder without the recording of its run.
const NO_RECORDING: &str = "expected the recording of a run. Long, functional and incomplete runs, and runs with \
    --no-bottlenecks, keep none beside the report; `basrelief run INPUT --recording FILE` writes one of any complete run with timing, \
    unless its user acts at times or a step takes more than 4294967295 cycles";

/// Opens a recording.
///
/// # Errors
/// A file that cannot be read.
pub fn open(path: &Path) -> CommandResult<zstd::Decoder<'static, BufReader<File>>> {
    let file = File::open(path).map_err(|error| {
        let is_of_folder = path.parent().is_some_and(|folder| folder.is_dir() && path == recording_in(folder));
        if error.kind() == ErrorKind::NotFound && is_of_folder {
            CommandError::in_input(&path.display().to_string())(format!("cannot be read: {error}; {NO_RECORDING}"))
        } else {
            CommandError::at_file(path, "be read")(error)
        }
    })?;
    zstd::Decoder::new(file).map_err(CommandError::at_file(path, "be read"))
}

/// Converts an error of a recording of this name or of the new parameters.
pub fn failure(name: &str) -> impl Fn(RecordingError) -> CommandError {
    let convert = CommandError::of_resimulation(unreadable(name));
    move |error| match convert(error) {
        CommandError::Usage(text) => CommandError::Usage(format!("--set: {text}")),
        bad => bad,
    }
}

/// Converts an error of a recording of this name.
pub fn unreadable(name: &str) -> impl Fn(RecordingError) -> CommandError {
    let name = name.to_owned();
    move |error| match error {
        // The decoder reports damage in its own words.
        RecordingError::Read(e) if e.raw_os_error().is_none() => {
            CommandError::in_input(&name)("not a recording, or damaged; `basrelief run --recording FILE` writes one")
        }
        _ => CommandError::in_input(&name)(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_recording_is_not_written() {
        let folder = tempfile::tempdir().unwrap();
        let left = |limits: AnalysisPolicy, pieces: &[bool]| {
            let mut recording = ShortRecording::new(limits).unwrap();
            pieces.iter().for_each(|is_short| recording.recording(b"chunk", *is_short).unwrap());
            let outputs = OutputFolder::begin(folder.path()).unwrap();
            recording.write_to(&outputs).unwrap()
        };
        assert!(left(AnalysisPolicy::IfShort, &[true, true]));
        assert!(!left(AnalysisPolicy::IfShort, &[true, false, true]) && !left(AnalysisPolicy::Always, &[true, false]));
        assert!(!left(AnalysisPolicy::Never, &[true]));
    }
}
