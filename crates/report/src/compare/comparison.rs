//! The difference of two reports as data.

use crate::model::Figure;
use serde::Serialize;

/// [`CauseShare::parameter`] of the work parameters and the input, if they are measured together.
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
    /// B - A, if both are numbers. A stall that a unit lacks is 0.
    pub delta: Option<f64>,
    /// Change relative to A, if both are numbers and A is not 0 \[%\].
    pub percent: Option<f64>,
}

/// Differences in one part of the reports, largest change first.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SectionChanges {
    /// `run`, `config`, `derived`, `cycles`, `units`, `fifos`, `memories`, `channels`, `caches`, `figures`, `quality` or `image`.
    pub table: &'static str,
    /// At least one.
    pub changes: Vec<FigureChange>,
    /// Number of the last changes that follow from those before them: parameters that no user changed.
    #[serde(skip_serializing_if = "is_zero")]
    pub derived: usize,
}

fn is_zero(n: &usize) -> bool {
    *n == 0
}

/// Largest regression.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LargestRegression {
    /// Size \[%\], finite; 0 if nothing got worse.
    pub percent: f64,
    /// Name of the figure.
    pub what: String,
    /// Loss of a PSNR \[dB\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub db: Option<f64>,
}

impl LargestRegression {
    /// The size in its own unit of measure.
    pub(super) fn size(&self) -> String {
        let percent = if self.percent < 0.05 { "less than 0.1 %".to_owned() } else { format!("{:.1} %", self.percent) };
        self.db.map_or_else(|| percent.clone(), |db| format!("{db:.2} dB ({percent} of A)"))
    }
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
        Self { worst: LargestRegression { percent: 0.0, what: "nothing".into(), db: None }, unjudged: vec![] }
    }
}

/// Part of the change of the cycles that one parameter causes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CauseShare {
    /// Parameter that the user changed; [`WORK`] for work parameters and input together.
    pub parameter: String,
    /// Parameters whose values follow from it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub derived: Vec<String>,
    /// `--set` options with which a full run of A takes `cycles`. For [`WORK`], only if both runs have the same input.
    pub set: Vec<String>,
    /// True if the machine ran once more for this figure; false if a recording was resimulated.
    pub needs_run: bool,
    /// Render cycles of A with this parameter as in B. `None` if it cannot be measured.
    pub cycles: Option<u64>,
    /// Effect alone: `cycles` minus the cycles of A.
    pub by: Option<i64>,
    /// Shapley value: mean effect over all orders of the changes. The shares of all causes sum to the whole change. Absent for many causes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share: Option<f64>,
}

/// Measured causes of the change of the cycles.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeasuredCauses {
    /// Causes, largest first. Causes that cannot be measured are last.
    #[serde(rename = "explained")]
    pub shares: Vec<CauseShare>,
    /// Rest of the change beyond all effects alone: the interaction of causes, and causes that cannot be measured.
    pub together: i64,
}

/// The difference of two reports; serializes to JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Nothing differs but the host.
    pub equal: bool,
    /// Change of time and cycles, and its causes, in a few sentences.
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
