//! The difference of two reports as data.

use crate::model::Figure;
use serde::Serialize;

/// [`CauseShare::group`] of the work parameters, which belong to no other group.
pub const WORK: &str = "work";

/// One figure that differs. Absent where a report has no such figure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FigureChange {
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
pub struct SectionChanges {
    /// `run`, `config`, `cycles`, `units`, `fifos`, `memories`, `channels`, `caches`, `figures`, `quality` or `image`.
    pub table: &'static str,
    /// At least one.
    pub changes: Vec<FigureChange>,
}

/// Largest regression.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LargestRegression {
    /// Size \[%\], finite; 0 if nothing got worse.
    pub percent: f64,
    /// Name of the figure.
    pub what: String,
}

/// A figure that counts and that cannot be judged.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct UnjudgedFigure {
    /// Name of the figure.
    pub figure: String,
    /// Reason.
    pub reason: String,
}

/// Judgement of the figures that count.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verdict {
    /// Largest regression of the judged figures.
    pub worst: LargestRegression,
    /// Figures that cannot be judged.
    pub unjudged: Vec<UnjudgedFigure>,
}

impl Default for Verdict {
    fn default() -> Self {
        Self { worst: LargestRegression { percent: 0.0, what: "nothing".into() }, unjudged: vec![] }
    }
}

/// Part of the change of the cycles that one group of parameters causes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CauseShare {
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
pub struct MeasuredCauses {
    /// Causes, largest first. Causes that cannot be measured are last.
    #[serde(rename = "explained")]
    pub shares: Vec<CauseShare>,
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
    pub explained: Option<MeasuredCauses>,
    /// Parts with differences.
    pub sections: Vec<SectionChanges>,
    /// The runs have different inputs, or the input of a run is unknown.
    pub other_input: bool,
    /// Largest regression, and counted figures that cannot be judged.
    #[serde(flatten)]
    pub verdict: Verdict,
}

impl Comparison {
    /// Returns the reasons for which B fails a limit of `percent`, one sentence each. Figures that cannot be judged fail every limit.
    /// The input is not considered; see [`Comparison::other_input`].
    pub fn failures(&self, percent: f64) -> Vec<String> {
        let Verdict { worst, unjudged } = &self.verdict;
        let unjudged = unjudged.iter().map(|UnjudgedFigure { figure, reason }| format!("{figure} cannot be judged: {reason}"));
        let is_over = worst.percent > percent;
        let over = is_over.then(|| format!("{} got worse by {} %; the limit is {percent} %", worst.what, worst.percent));
        unjudged.chain(over).collect()
    }
}
