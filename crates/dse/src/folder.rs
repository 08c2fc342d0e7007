//! Storage of points: `points/HASH/report.json` of a complete run, `failed.json` of a failed run, and the picture.
//!
//! Files appear as a whole, and every writer writes the same bytes. So nothing is locked, and any number of processes and machines can
//! work on one folder. Both files state the build of the simulator that wrote them, because another build may give other results.

use crate::plan::PlanPoint;
use crate::{SweepError, SweepHost};
use basrelief_report::Report;
use basrelief_sim::BUILD;
use basrelief_threads as threads;
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
pub struct SweepFolder(PathBuf);

/// State of a point in the folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointStatus {
    /// The point has a report.
    Report,
    /// The point failed with a stored reason.
    Failed,
    /// Another build of the simulator made the result.
    Outdated,
    /// The point has no result, a damaged one, or an incomplete one of a killed process.
    Missing,
}

impl PointStatus {
    /// Returns true if the point must run.
    pub fn is_missing(self) -> bool {
        matches!(self, Self::Outdated | Self::Missing)
    }
}

/// Storage of points: a [`SweepFolder`], or a store that keeps only some figures.
pub trait PointStore: Sync {
    /// State of a point in the folder.
    fn find(&self, id: &str) -> PointStatus;

    /// Stores the report of a point after its picture, and removes an earlier failure.
    ///
    /// # Errors
    /// A file that cannot be written.
    fn put(&self, id: &str, report: &Report, picture: Option<&[u8]>, host: &dyn SweepHost) -> Result<(), SweepError>;

    /// Stores the reason why a point has no report.
    ///
    /// # Errors
    /// A file that cannot be written.
    fn put_failure(&self, id: &str, failure: &PointFailure, host: &dyn SweepHost) -> Result<(), SweepError>;
}

impl PointStore for SweepFolder {
    fn find(&self, id: &str) -> PointStatus {
        Self::find(self, id)
    }

    fn put(&self, id: &str, report: &Report, picture: Option<&[u8]>, host: &dyn SweepHost) -> Result<(), SweepError> {
        let text = report.to_json().map_err(|error| SweepError(error.to_string()))?;
        Self::put(self, id, &text, picture, host)
    }

    fn put_failure(&self, id: &str, failure: &PointFailure, host: &dyn SweepHost) -> Result<(), SweepError> {
        let PointFailure { outcome, message } = failure.clone();
        let failed = FailedPoint { build: BUILD.into(), outcome, message };
        let text = serde_json::to_string_pretty(&failed).map_err(|e| SweepError(e.to_string()))?;
        self.remove_outdated(id)?;
        publish(&self.of_point(id, FAILED), format!("{text}\n").as_bytes(), host)
    }
}

/// Content of `failed.json`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct FailedPoint {
    /// Absent in version 0.1.
    #[serde(default)]
    build: String,
    outcome: String,
    message: String,
}

/// The build that wrote a file of a point. The other fields are only checked to be JSON.
#[derive(Deserialize)]
struct WrittenBy {
    #[serde(default)]
    build: String,
}

/// Why a point has no report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PointFailure {
    /// In one word: `deadlock`, `limit`, `fault`, `unfit` of parameters, or `error`.
    pub outcome: String,
    /// In a sentence.
    pub message: String,
}

impl SweepFolder {
    /// Creates a handle of the folder at this path, which need not exist.
    pub fn new(path: &Path) -> Self {
        Self(path.into())
    }

    /// Returns the path of a file of the whole sweep.
    pub fn path_of(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn of_point(&self, id: &str, name: &str) -> PathBuf {
        self.0.join("points").join(id).join(name)
    }

    /// State of a point in the folder. Reads its files to their ends, because a power cut can leave empty or torn files.
    pub fn find(&self, id: &str) -> PointStatus {
        let builds = [REPORT, FAILED].map(|name| {
            let bytes = fs::read(self.of_point(id, name)).ok()?;
            serde_json::from_slice(&bytes).ok().map(|WrittenBy { build }| build)
        });
        match builds.each_ref().map(Option::as_deref) {
            [Some(BUILD), _] => PointStatus::Report,
            [_, Some(BUILD)] => PointStatus::Failed,
            [None, None] => PointStatus::Missing,
            _ => PointStatus::Outdated,
        }
    }

    /// States of several points, in their order.
    pub fn find_all(&self, points: &[&PlanPoint]) -> Vec<PointStatus> {
        threads::par_map(points.to_vec(), |point| self.find(&point.id))
    }

    /// Removes a report that does not count, so that it never lies beside a new picture.
    fn remove_outdated(&self, id: &str) -> Result<(), SweepError> {
        if self.find(id).is_missing() { remove(&self.of_point(id, REPORT)) } else { Ok(()) }
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
    pub fn failure(&self, id: &str) -> Result<PointFailure, SweepError> {
        let path = self.of_point(id, FAILED);
        let text = fs::read_to_string(&path).map_err(|e| SweepError(format!("{}: cannot be read: {e}", path.display())))?;
        let FailedPoint { outcome, message, .. } = parse(&text, &path)?;
        Ok(PointFailure { outcome, message })
    }

    /// The picture of a point, relative to the folder, where it has one.
    pub fn picture(&self, id: &str) -> Option<String> {
        self.of_point(id, PICTURE).is_file().then(|| format!("points/{id}/{PICTURE}"))
    }

    /// Stores the report of a point after its picture, and removes an earlier failure.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn put(&self, id: &str, report: &str, picture: Option<&[u8]>, host: &dyn SweepHost) -> Result<(), SweepError> {
        self.remove_outdated(id)?;
        if let Some(picture) = picture {
            publish(&self.of_point(id, PICTURE), picture, host)?;
        }
        if let Err(error) = publish(&self.of_point(id, REPORT), report.as_bytes(), host) {
            // Without its report the picture is of no use. (Another process may have stored both meanwhile.)
            if picture.is_some() && self.find(id).is_missing() {
                let _ = fs::remove_file(self.of_point(id, PICTURE));
            }
            return Err(error);
        }
        remove(&self.of_point(id, FAILED))
    }
}

fn remove(path: &Path) -> Result<(), SweepError> {
    match fs::remove_file(path) {
        Err(e) if e.kind() != ErrorKind::NotFound => Err(SweepError(format!("{}: cannot be removed: {e}", path.display()))),
        _ => Ok(()),
    }
}

fn parse<T: serde::de::DeserializeOwned>(text: &str, path: &Path) -> Result<T, SweepError> {
    let wrong = |e| SweepError(format!("{}: {e}: no basrelief wrote this; remove it, and run the sweep again", path.display()));
    serde_json::from_str(text).map_err(wrong)
}

/// Puts a file in its place.
pub(crate) fn publish(path: &Path, bytes: &[u8], host: &dyn SweepHost) -> Result<(), SweepError> {
    host.publish(path, bytes).map_err(|e| SweepError(format!("{}: cannot be written: {e}", path.display())))
}
