//! `--tape`, and `basrelief retime`: the work of a run kept, and timed again.

use super::simulate::{limits_of, seconds, show_report, write_report};
use crate::args::RetimeArgs;
use crate::error::{Done, Failure, print};
use crate::outputs::{Outputs, PartialFile};
use basrelief_input::Budget;
use basrelief_session::{RetimeOptions, TapeFileError, retime as timed_again};
use std::fs::File;
use std::io::{BufReader, Write};
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

/// Opens a tape.
///
/// # Errors
/// A file that cannot be read.
pub fn open(path: &Path) -> Done<zstd::Decoder<'static, BufReader<File>>> {
    let file = File::open(path).map_err(Failure::file(path, "be read"))?;
    zstd::Decoder::new(file).map_err(Failure::file(path, "be read"))
}

/// What is wrong with a tape of this name, or with what was to be done with it.
pub fn failure(name: &str) -> impl Fn(TapeFileError) -> Failure {
    let name = name.to_owned();
    move |error| match error {
        TapeFileError::Work(_) | TapeFileError::OtherWork(_) | TapeFileError::Config(_) => {
            Failure::Usage(format!("--set: {error}"))
        }
        // What the decoder says in its own words.
        TapeFileError::Read(e) if e.raw_os_error().is_none() => {
            Failure::within(&name)("not a tape, or not whole; `basrelief run --tape FILE` makes one")
        }
        _ => Failure::within(&name)(error),
    }
}

/// Times the work on a tape again.
pub fn retime(args: &RetimeArgs, budget: &Budget, quiet: bool) -> Done {
    let began = seconds();
    let name = args.tape.display().to_string();
    let mut reader = open(&args.tape)?;
    let limits = limits_of(args.limits, args.no_limits);
    let options = RetimeOptions { settings: args.settings.clone(), limits, budget: budget.clone() };
    let report = timed_again(&mut reader, &options).map_err(failure(&name))?;
    let took = seconds() - began;
    let report = report.with_host(took, took);
    if args.json {
        print(&report.to_json().map_err(Failure::bad)?)?;
    }
    if let Some(folder) = &args.out {
        let outputs = Outputs::begin(folder).map_err(Failure::file(folder, "be written"))?;
        write_report(&outputs, &report, args.csv).map_err(Failure::file(folder, "be written"))?;
        outputs.publish("report.json").map_err(Failure::file(folder, "be written"))?;
    }
    if quiet || args.json { Ok(()) } else { show_report(&report) }
}
