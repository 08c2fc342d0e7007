//! Change of a run when one assumed parameter changes.

use crate::number::round6;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// So many percent a decibel counts for where rows are put in order: a decibel more error is as much more in root mean square.
const PERCENT_PER_DB: f64 = 12.2;

/// A run with each assumed parameter changed, one at a time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Sensitivity {
    /// The run as it is configured.
    pub base: Measure,
    /// What moves most first, by the largest of its three moves, of which a decibel counts as 12.2 %; equal ones in the order of the
    /// parameters; what came to no end last.
    pub changes: Vec<Change>,
    /// Assumed parameters that have no neighbours: texts, and lists without values.
    pub unchanged: Vec<String>,
}

/// What is measured of each run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Measure {
    /// Of the frames, without the drain behind the last.
    pub cycles: u64,
    /// That all memories moved.
    pub bytes: u64,
    /// Of the final picture \[dB\]; absent without exact pictures.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub psnr_db: Option<f64>,
}

/// The run with one parameter at another value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Change {
    /// As `--set` names it.
    pub parameter: String,
    /// What it is.
    pub about: String,
    /// Its unit of measure; empty for a switch or a choice.
    pub unit: String,
    /// Its value in the run.
    pub from: Value,
    /// Its value here.
    pub to: Value,
    /// What it comes to.
    #[serde(flatten)]
    pub comes_to: ComesTo,
}

/// What a change comes to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum ComesTo {
    /// To another run, which came to its end.
    Run(Moved),
    /// To none.
    Nothing {
        /// `unfit`, `deadlock`, `limit`, `fault` or `error`, and why.
        reason: String,
    },
}

/// How far a run is from the one as configured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Moved {
    /// What it came to.
    #[serde(flatten)]
    pub measure: Measure,
    /// Change of the cycles, rounded to 6 decimals \[%\].
    pub cycles_percent: f64,
    /// Change of the bytes, rounded to 6 decimals \[%\]; 0 where none were moved before.
    pub bytes_percent: f64,
    /// Change of the picture, rounded to 6 decimals, more is better \[dB\]; absent without exact pictures.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub psnr_change_db: Option<f64>,
}

impl Measure {
    /// How far a run is from this one.
    pub fn moved(&self, to: Self) -> Moved {
        let percent = |from: u64, to: u64| if from == 0 { 0.0 } else { round6(100.0 * (to as f64 - from as f64) / from as f64) };
        Moved {
            measure: to,
            cycles_percent: percent(self.cycles, to.cycles),
            bytes_percent: percent(self.bytes, to.bytes),
            psnr_change_db: self.psnr_db.zip(to.psnr_db).map(|(from, to)| round6(to - from)),
        }
    }
}

impl Moved {
    /// Its largest move \[%\].
    pub(crate) fn size(&self) -> f64 {
        let decibels = self.psnr_change_db.unwrap_or(0.0) * PERCENT_PER_DB;
        self.cycles_percent.abs().max(self.bytes_percent.abs()).max(decibels.abs())
    }
}

impl Change {
    /// How much it moves \[%\]; none where it came to no end.
    pub(crate) fn size(&self) -> Option<f64> {
        match &self.comes_to {
            ComesTo::Run(moved) => Some(moved.size()),
            ComesTo::Nothing { .. } => None,
        }
    }
}

impl Sensitivity {
    /// Changes in the order of the parameters are put in that of what they move.
    pub fn new(base: Measure, mut changes: Vec<Change>, unchanged: Vec<String>) -> Self {
        // Stable. None is less than any number.
        changes.sort_by(|a, b| b.size().partial_cmp(&a.size()).unwrap_or(std::cmp::Ordering::Equal));
        Self { base, changes, unchanged }
    }
}
