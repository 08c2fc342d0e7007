//! Change of a run when one assumed parameter changes.

use crate::number::round6;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Weight of a decibel in the order of rows \[%\]: one decibel is 12.2 % of root-mean-square error.
pub(crate) const PERCENT_PER_DB: f64 = 12.2;

/// Changes of a run when one assumed parameter changes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Sensitivity {
    /// The run with the given configuration.
    pub base: Measure,
    /// Changes, largest effect first. The effect is the largest of the changes of cycles, time, bytes, area and quality; a decibel
    /// counts as 12.2 %. Equal effects keep the order of the parameters. Runs that did not finish are last.
    pub changes: Vec<ParameterChange>,
    /// Assumed parameters without neighbouring values: texts, and empty lists.
    #[serde(rename = "not_varied", alias = "unchanged")]
    pub unchanged: Vec<String>,
}

/// Measures of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Measure {
    /// Render cycles.
    pub cycles: u64,
    /// Mean time of a frame \[ms\]. Absent in a report of a version without it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame_ms: Option<f64>,
    /// Bytes that all memories moved.
    pub bytes: u64,
    /// Area of the machine \[gate equivalents\]; 0 in a report of a version without areas.
    #[serde(default)]
    pub area_ge: u64,
    /// Worst PSNR of all images \[dB\]. Absent without reference images.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub psnr_db: Option<f64>,
}

/// Result of one changed parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "Change")]
pub struct ParameterChange {
    /// Parameter, as in `--set`.
    pub parameter: String,
    /// Meaning.
    #[serde(rename = "description", alias = "about")]
    pub about: String,
    /// Unit of measure; empty for a switch or a choice.
    pub unit: String,
    /// Value in the base run.
    pub from: Value,
    /// Changed value.
    pub to: Value,
    /// Result.
    #[serde(flatten)]
    pub comes_to: ComesTo,
}

/// Result of a changed parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected the measures of a run, or the reason why there are none")]
pub enum ComesTo {
    /// A complete run.
    Run(MeasureChange),
    /// No complete run.
    Nothing {
        /// `unfit`, `deadlock`, `limit`, `fault` or `error`, and the reason.
        reason: String,
    },
}

/// Difference of a run from the base run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "Moved")]
pub struct MeasureChange {
    /// Measures of the run.
    #[serde(flatten)]
    pub measure: Measure,
    /// Change of the render cycles, rounded to 6 decimals \[%\].
    pub cycles_percent: f64,
    /// Change of the time of a frame, rounded to 6 decimals \[%\]. It differs from the change of the cycles if the clock changes.
    #[serde(default)]
    pub time_percent: f64,
    /// Change of the bytes, rounded to 6 decimals \[%\]. 0 if the base run moved no bytes.
    pub bytes_percent: f64,
    /// Change of the area, rounded to 6 decimals \[%\].
    #[serde(default)]
    pub area_percent: f64,
    /// Change of the PSNR, rounded to 6 decimals; more is better \[dB\]. Absent without reference images.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub psnr_change_db: Option<f64>,
}

impl Measure {
    /// Returns the difference of a run from this one.
    pub fn change_to(&self, to: Self) -> MeasureChange {
        let relative = |from: f64, to: f64| if from == 0.0 { 0.0 } else { round6(100.0 * (to - from) / from) };
        let percent = |from: u64, to: u64| relative(from as f64, to as f64);
        MeasureChange {
            measure: to,
            cycles_percent: percent(self.cycles, to.cycles),
            time_percent: self.frame_ms.zip(to.frame_ms).map_or(0.0, |(from, to)| relative(from, to)),
            bytes_percent: percent(self.bytes, to.bytes),
            area_percent: percent(self.area_ge, to.area_ge),
            psnr_change_db: self.psnr_db.zip(to.psnr_db).map(|(from, to)| round6(to - from)),
        }
    }
}

impl MeasureChange {
    /// Returns the largest change \[%\].
    pub(crate) fn largest_change(&self) -> f64 {
        let decibels = self.psnr_change_db.unwrap_or(0.0) * PERCENT_PER_DB;
        let changes = [self.cycles_percent, self.time_percent, self.bytes_percent, self.area_percent, decibels];
        changes.into_iter().fold(0.0, |most, x| most.max(x.abs()))
    }
}

impl ParameterChange {
    /// Returns the largest change \[%\], or `None` if the run did not finish.
    pub(crate) fn largest_change(&self) -> Option<f64> {
        match &self.comes_to {
            ComesTo::Run(moved) => Some(moved.largest_change()),
            ComesTo::Nothing { .. } => None,
        }
    }
}

impl Sensitivity {
    /// Sorts changes by their effect. `changes` are in the order of the parameters.
    pub fn new(base: Measure, mut changes: Vec<ParameterChange>, unchanged: Vec<String>) -> Self {
        // The sort is stable, and `None` is less than any number.
        changes.sort_by(|a, b| b.largest_change().partial_cmp(&a.largest_change()).unwrap_or(std::cmp::Ordering::Equal));
        Self { base, changes, unchanged }
    }
}
