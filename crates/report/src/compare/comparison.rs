//! The difference of two reports as data.

use crate::model::Figure;
use serde::Serialize;

/// What belongs to no group of parameters: [`Share::group`] of what the units do.
pub const WORK: &str = "work";

/// One figure that differs. Absent where a report has no such figure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Change {
    /// Unit, FIFO, memory, parameter ...
    pub name: String,
    /// Which figure of it.
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

/// What differs in one part of the reports, the largest change first.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Section {
    /// `run`, `config`, `cycles`, `units`, `fifos`, `memories`, `channels`, `caches`, `figures`, `quality` or `image`.
    pub table: &'static str,
    /// At least one.
    pub changes: Vec<Change>,
}

/// What got worse most.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Worst {
    /// By how much \[%\]; 0 if nothing got worse.
    pub percent: f64,
    /// What.
    pub what: String,
}

/// What one group of parameters, or the work, has to do with the change of the cycles.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Share {
    /// `memory.NAME`, `cache.NAME`, `fifo.NAME`, or the first part of the keys; [`WORK`] for what the units do.
    pub group: String,
    /// `--set` options with which a full run of B takes `cycles`; of the work, if both have the same input. None where no options say
    /// it.
    pub set: Vec<String>,
    /// Cycles of the frames where this is as in A and all else as in B; none where no tape can be timed so.
    pub cycles: Option<u64>,
    /// What it changes in B: B's cycles less these.
    pub by: Option<i64>,
}

/// What explains the change of the cycles, measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Explained {
    /// The largest first; those that could not be measured last.
    #[serde(rename = "explained")]
    pub shares: Vec<Share>,
    /// What no share has: what changes only together, and what could not be measured.
    pub together: i64,
}

/// The difference of two reports; serializes to JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Nothing differs but the host.
    pub equal: bool,
    /// What the cycles have changed by, and through what, in one or two sentences.
    pub explanation: String,
    /// The same as data, where it was measured.
    #[serde(flatten)]
    pub explained: Option<Explained>,
    /// Only parts in which something differs.
    pub sections: Vec<Section>,
    /// What got worse most.
    pub worst: Worst,
}

impl Comparison {
    /// By how much B is worse than A \[%\]; 0 if nothing is. Infinite if A is complete and B is not.
    pub fn worst_percent(&self) -> f64 {
        self.worst.percent
    }
}
