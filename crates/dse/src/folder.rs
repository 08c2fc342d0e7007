//! Storage of points: `points/HASH/report.json` of a complete run, `failed.json` of a failed run, and the picture.
//!
//! Files appear as a whole, and every writer writes the same bytes. So nothing is locked, and any number of processes and machines can
//! work on one folder.

use crate::{Host, SweepError};
use basrelief_report::Report;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

const REPORT: &str = "report.json";
const FAILED: &str = "failed.json";
const PICTURE: &str = "image.png";

/// A folder of points.
#[derive(Clone, Debug)]
pub struct Folder(PathBuf);

/// State of a point in the folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Found {
    /// The point has a report.
    Report,
    /// The point failed with a stored reason.
    Failed,
    /// The point has no result, or an incomplete one of a killed process.
    Missing,
}

/// Storage of points: a [`Folder`], or a store that keeps only some figures.
pub trait Store: Sync {
    /// State of a point in the folder.
    fn find(&self, id: &str) -> Found;

    /// Stores the report of a point after its picture, and removes an earlier failure.
    ///
    /// # Errors
    /// A file that cannot be written.
    fn put(&self, id: &str, of: (&Report, Option<&[u8]>), host: &dyn Host) -> Result<(), SweepError>;

    /// Stores the reason why a point has no report.
    ///
    /// # Errors
    /// A file that cannot be written.
    fn put_failure(&self, id: &str, failure: &Failure, host: &dyn Host) -> Result<(), SweepError>;
}

impl Store for Folder {
    fn find(&self, id: &str) -> Found {
        Self::find(self, id)
    }

    fn put(&self, id: &str, (report, picture): (&Report, Option<&[u8]>), host: &dyn Host) -> Result<(), SweepError> {
        let text = report.to_json().map_err(|error| SweepError(error.to_string()))?;
        Self::put(self, id, (&text, picture), host)
    }

    fn put_failure(&self, id: &str, failure: &Failure, host: &dyn Host) -> Result<(), SweepError> {
        let text = serde_json::to_string_pretty(failure).map_err(|e| SweepError(e.to_string()))?;
        publish(&self.of_point(id, FAILED), format!("{text}\n").as_bytes(), host)
    }
}

/// Why a point has no report.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Failure {
    /// In one word: `deadlock`, `limit`, `fault`, `unfit` of parameters, or `error`.
    pub outcome: String,
    /// In a sentence.
    pub message: String,
}

impl Folder {
    /// Creates a handle of the folder at this path, which need not exist.
    pub fn new(path: &Path) -> Self {
        Self(path.into())
    }

    /// Returns the path of a file of the whole sweep.
    pub fn place(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn of_point(&self, id: &str, name: &str) -> PathBuf {
        self.0.join("points").join(id).join(name)
    }

    /// State of a point in the folder.
    pub fn find(&self, id: &str) -> Found {
        match [REPORT, FAILED].map(|name| self.of_point(id, name).is_file()) {
            [true, _] => Found::Report,
            [_, true] => Found::Failed,
            _ => Found::Missing,
        }
    }

    /// The report of a point, as it was written.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn report_text(&self, id: &str) -> Result<String, SweepError> {
        let path = self.of_point(id, REPORT);
        fs::read_to_string(&path).map_err(|e| SweepError(format!("{}: cannot be read: {e}", path.display())))
    }

    /// The report of a point.
    ///
    /// # Errors
    /// A file that cannot be read, or is no report.
    pub fn report(&self, id: &str) -> Result<Value, SweepError> {
        parse(&self.report_text(id)?, &self.of_point(id, REPORT))
    }

    /// Returns the reason of a failed point.
    ///
    /// # Errors
    /// A file that cannot be read, or has other content.
    pub fn failure(&self, id: &str) -> Result<Failure, SweepError> {
        let path = self.of_point(id, FAILED);
        let text = fs::read_to_string(&path).map_err(|e| SweepError(format!("{}: cannot be read: {e}", path.display())))?;
        parse(&text, &path)
    }

    /// The picture of a point, relative to the folder, where it has one.
    pub fn picture(&self, id: &str) -> Option<String> {
        self.of_point(id, PICTURE).is_file().then(|| format!("points/{id}/{PICTURE}"))
    }

    /// Stores the report of a point after its picture, and removes an earlier failure.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn put(&self, id: &str, (report, picture): (&str, Option<&[u8]>), host: &dyn Host) -> Result<(), SweepError> {
        if let Some(picture) = picture {
            publish(&self.of_point(id, PICTURE), picture, host)?;
        }
        publish(&self.of_point(id, REPORT), report.as_bytes(), host)?;
        let failed = self.of_point(id, FAILED);
        match fs::remove_file(&failed) {
            Err(e) if e.kind() != ErrorKind::NotFound => Err(SweepError(format!("{}: cannot be removed: {e}", failed.display()))),
            _ => Ok(()),
        }
    }
}

fn parse<T: serde::de::DeserializeOwned>(text: &str, path: &Path) -> Result<T, SweepError> {
    let wrong = |e| SweepError(format!("{}: {e}: no basrelief wrote this; remove it, and run the sweep again", path.display()));
    serde_json::from_str(text).map_err(wrong)
}

/// Puts a file in its place.
pub(crate) fn publish(path: &Path, bytes: &[u8], host: &dyn Host) -> Result<(), SweepError> {
    host.publish(path, bytes).map_err(|e| SweepError(format!("{}: cannot be written: {e}", path.display())))
}
