//! The difference of two reports as data.

use crate::model::Figure;
use serde::Serialize;

/// [`Share::group`] of the work parameters, which belong to no other group.
pub const WORK: &str = "work";

/// One figure that differs. Absent where a report has no such figure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Change {
    /// Unit, FIFO, memory, parameter ...
    pub name: String,
    /// Name of the figure.
    pub field: &'static str,
    /// Which one of several: FIFO, client, frame.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub key: String,
    /// In report A.
    pub a: Option<Figure>,
    /// In report B.
    pub b: Option<Figure>,
    /// B - A, if both are numbers; a missing count is 0.
    pub delta: Option<f64>,
    /// Change relative to A, if A is a number other than 0 \[%\].
    pub percent: Option<f64>,
}

/// Differences in one part of the reports, largest change first.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Section {
    /// `run`, `config`, `cycles`, `units`, `fifos`, `memories`, `channels`, `caches`, `figures`, `quality` or `image`.
    pub table: &'static str,
    /// At least one.
    pub changes: Vec<Change>,
}

/// Largest regression.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Worst {
    /// Size \[%\]; 0 if nothing got worse.
    pub percent: f64,
    /// Kind and name.
    pub what: String,
}

/// Part of the change of the cycles that one group of parameters causes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Share {
    /// `memory.NAME`, `cache.NAME`, `fifo.NAME`, or the first part of the keys; [`WORK`] for work parameters.
    pub group: String,
    /// `--set` options with which a full run of B takes `cycles`. For work parameters, only if both runs have the same input. Empty if no
    /// options have that effect.
    pub set: Vec<String>,
    /// Render cycles with this group as in A and all else as in B. `None` if no recording can be resimulated so.
    pub cycles: Option<u64>,
    /// Cycles of B minus `cycles`.
    pub by: Option<i64>,
}

/// Measured causes of the change of the cycles.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Explained {
    /// Causes, largest first. Causes that cannot be measured are last.
    #[serde(rename = "explained")]
    pub shares: Vec<Share>,
    /// Rest of the change: the interaction of causes, and causes that cannot be measured.
    pub together: i64,
}

/// The difference of two reports; serializes to JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Nothing differs but the host.
    pub equal: bool,
    /// Change of the cycles and its causes, in a few sentences.
    pub explanation: String,
    /// The causes as data, if they were measured.
    #[serde(flatten)]
    pub explained: Option<Explained>,
    /// Parts with differences.
    pub sections: Vec<Section>,
    /// Largest regression.
    pub worst: Worst,
}

impl Comparison {
    /// Returns the largest regression of B against A \[%\]; 0 if there is none. Infinite if A is complete and B is not.
    pub fn worst_percent(&self) -> f64 {
        self.worst.percent
    }
}
