//! `--tape`, and `basrelief retime`: the work of a run kept, and timed again.

use super::html::HtmlFile;
use super::simulate::{limits_of, publish_report, seconds, show_report};
use crate::args::RetimeArgs;
use crate::error::{Done, Failure, print};
use crate::outputs::{Outputs, PartialFile, RUN_TAPE, check_distinct, check_not_read};
use basrelief_input::Budget;
use basrelief_sim::{AnalysisPolicy, Observer, RecordingError, ResimulateOptions, resimulate_to};
use std::fs::File;
use std::io::{self, BufReader, Write};
use std::path::{Path, PathBuf};

/// The file of `--tape`, compressed with zstd.
pub struct TapeFile {
    path: PathBuf,
    encoder: zstd::Encoder<'static, PartialFile>,
}

impl TapeFile {
    /// Opens it.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn open(path: &Path) -> Done<Self> {
        let failed = || Failure::file(path, "be written");
        let file = PartialFile::create(path).map_err(failed())?;
        let mut encoder = zstd::Encoder::new(file, zstd::DEFAULT_COMPRESSION_LEVEL).map_err(failed())?;
        encoder.include_checksum(true).map_err(failed())?;
        Ok(Self { path: path.into(), encoder })
    }

    /// Goes on.
    ///
    /// # Errors
    /// A file that cannot be written, in a sentence.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), String> {
        self.encoder.write_all(bytes).map_err(|e| format!("{}: cannot be written: {e}", self.path.display()))
    }

    /// The file, to be published.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(self) -> Done<PartialFile> {
        let mut file = self.encoder.finish().map_err(Failure::file(&self.path, "be written"))?;
        file.flush().map_err(Failure::file(&self.path, "be written"))?;
        Ok(file)
    }
}

/// The tape that is left beside a report, of a run whose work is short: compressed, and in memory until the run has come to its end.
pub struct RunTape {
    /// None where nobody wants it, or once it was too long.
    encoder: Option<zstd::Encoder<'static, Vec<u8>>>,
}

impl RunTape {
    /// An empty one, of a run whose [limits](AnalysisPolicy) are measured.
    ///
    /// # Errors
    /// None that is known.
    pub fn new(limits: AnalysisPolicy) -> Done<Self> {
        let encoder = || zstd::Encoder::new(Vec::new(), zstd::DEFAULT_COMPRESSION_LEVEL);
        let encoder = (limits != AnalysisPolicy::Never).then(encoder).transpose().map_err(Failure::bad)?;
        Ok(Self { encoder })
    }

    /// Puts it beside the report; whether there is one.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write_to(self, outputs: &Outputs) -> io::Result<bool> {
        let Some(encoder) = self.encoder else { return Ok(false) };
        let mut file = outputs.create(RUN_TAPE)?;
        file.write_all(&encoder.finish()?).and_then(|()| file.flush()).map(|()| true)
    }
}

impl Observer for RunTape {
    fn recording(&mut self, bytes: &[u8], is_short: bool) -> Result<(), String> {
        self.encoder = self.encoder.take().filter(|_| is_short);
        self.encoder.as_mut().map_or(Ok(()), |encoder| encoder.write_all(bytes)).map_err(|e| e.to_string())
    }
}

/// The file of a tape: of a folder, the one beside its report.
pub fn place_of(path: &Path) -> PathBuf {
    if path.is_dir() { path.join(RUN_TAPE) } else { path.to_path_buf() }
}

/// Opens a tape.
///
/// # Errors
/// A file that cannot be read.
pub fn open(path: &Path) -> Done<zstd::Decoder<'static, BufReader<File>>> {
    let file = File::open(path).map_err(Failure::file(path, "be read"))?;
    zstd::Decoder::new(file).map_err(Failure::file(path, "be read"))
}

/// What is wrong with a tape of this name, or with what was to be done with it.
pub fn failure(name: &str) -> impl Fn(RecordingError) -> Failure {
    let name = name.to_owned();
    move |error| match error {
        RecordingError::Work(_) | RecordingError::OtherWork(_) | RecordingError::Config(_) => {
            Failure::Usage(format!("--set: {error}"))
        }
        _ => unreadable(&name)(error),
    }
}

/// What is wrong with a tape of this name by itself.
pub fn unreadable(name: &str) -> impl Fn(RecordingError) -> Failure {
    let name = name.to_owned();
    move |error| match error {
        // What the decoder says in its own words.
        RecordingError::Read(e) if e.raw_os_error().is_none() => {
            Failure::within(&name)("not a recording, or incomplete; make one with `basrelief run --tape FILE`")
        }
        _ => Failure::within(&name)(error),
    }
}

/// Times the work on a tape again.
pub fn retime(args: &RetimeArgs, budget: &Budget, quiet: bool) -> Done {
    let began = seconds();
    let path = place_of(&args.tape);
    let name = path.display().to_string();
    let own = args.out.as_ref().map(|folder| folder.join(RUN_TAPE));
    let page: Vec<(&str, &Path)> = args.html.iter().map(|page| ("--html", &**page)).collect();
    let outputs: Vec<(&str, &Path)> = own.iter().map(|own| ("--out", &**own)).chain(page.iter().copied()).collect();
    check_not_read(&outputs, &[("TAPE", &path)]).map_err(Failure::Usage)?;
    if let Some(folder) = &args.out {
        check_distinct(folder, &page).map_err(Failure::Usage)?;
    }
    let mut reader = open(&path)?;
    let limits = limits_of(args.limits, args.no_limits);
    let options = ResimulateOptions { settings: args.settings.clone(), bottlenecks: limits, budget: budget.clone() };
    let mut tape = RunTape::new(limits)?;
    let report = resimulate_to(&mut reader, &options, &mut tape).map_err(failure(&name))?;
    let took = seconds() - began;
    let report = report.with_host(took, took);
    let page = args.html.as_deref().map(|path| HtmlFile::open(path)?.finish(&report)).transpose()?;
    if args.json {
        print(&report.to_json().map_err(Failure::bad)?)?;
    }
    if let Some(folder) = &args.out {
        let outputs = Outputs::begin(folder).map_err(Failure::file(folder, "be written"))?;
        tape.write_to(&outputs).map_err(Failure::file(folder, "be written"))?;
        publish_report(outputs, &report, args.csv).map_err(Failure::file(folder, "be written"))?;
    }
    if let (Some(page), Some(path)) = (page, &args.html) {
        page.publish().map_err(Failure::file(path, "be written"))?;
    }
    if quiet || args.json { Ok(()) } else { show_report(&report, &args.tables) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tape_that_has_grown_too_long_is_not_left() {
        let folder = tempfile::tempdir().unwrap();
        let left = |limits: AnalysisPolicy, pieces: &[bool]| {
            let mut tape = RunTape::new(limits).unwrap();
            pieces.iter().for_each(|is_short| tape.recording(b"piece", *is_short).unwrap());
            let outputs = Outputs::begin(folder.path()).unwrap();
            tape.write_to(&outputs).unwrap()
        };
        assert!(left(AnalysisPolicy::IfShort, &[true, true]));
        assert!(!left(AnalysisPolicy::IfShort, &[true, false, true]) && !left(AnalysisPolicy::Always, &[true, false]));
        assert!(!left(AnalysisPolicy::Never, &[true]));
    }
}
