//! A plan as it is written.

use crate::{Constraint, Objective, ObjectiveDirection};
use basrelief_parameters::{nearest, syntax};
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::{Map, Value};
use toml::Table;

/// The plan file. docs/guide/sweep-and-explore.md describes its fields.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct PlanFile {
    /// Title of tables and pages.
    pub(super) title: Option<String>,
    /// Inputs: `demo:NAME`, a model, or a trace.
    pub(super) input: InputList,
    /// Machine; without it, that of the demo.
    pub(super) machine: Option<String>,
    /// Parameters of all points, or the name of a file with them.
    pub(super) config: Option<BaseConfig>,
    /// View of all points.
    #[serde(default)]
    #[schemars(with = "Map<String, Value>")]
    pub(super) view: Table,
    /// Views of each point, over `view`. Each draws one frame unless it states more.
    #[serde(default)]
    #[schemars(with = "Vec<Map<String, Value>>")]
    pub(super) views: Vec<Table>,
    /// Cycles after which a run stops.
    pub(super) max_cycles: Option<u64>,
    /// Parameters and their values.
    #[serde(default)]
    #[schemars(with = "Map<String, Value>")]
    pub(super) axes: Table,
    /// Parameters that take their values together.
    #[serde(default)]
    #[schemars(with = "Vec<Map<String, Value>>")]
    pub(super) zip: Vec<Table>,
    /// Points that are left out.
    #[serde(default)]
    #[schemars(with = "Vec<Map<String, Value>>")]
    pub(super) exclude: Vec<Table>,
    /// Sampling, instead of all combinations.
    pub(super) samples: Option<SampleOptions>,
    /// Figures that are minimized or maximized.
    pub(super) objectives: Vec<WrittenObjective>,
    /// Conditions of a fit point, such as `quality.psnr_db >= 30`.
    #[serde(default)]
    pub(super) constraints: Vec<String>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected the name of an input, such as \"demo:golf-ball\", or a list of them")]
pub(super) enum InputList {
    One(String),
    Several(Vec<String>),
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected parameters, as in a file of --config, or the name of such a file")]
pub(super) enum BaseConfig {
    File(String),
    Inline(#[schemars(with = "Map<String, Value>")] Table),
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SampleOptions {
    pub(super) method: SampleMethod,
    pub(super) points: Option<usize>,
    #[serde(default)]
    pub(super) seed: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum SampleMethod {
    Grid,
    LatinHypercube,
    Sobol,
    OneAtATime,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected \"FIGURE min\", \"FIGURE max\" or { figure = \"FIGURE\", goal = \"min\" }")]
pub(super) enum WrittenObjective {
    Text(String),
    Fields(ObjectiveFields),
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ObjectiveFields {
    figure: String,
    goal: WrittenGoal,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum WrittenGoal {
    Min,
    Max,
}

impl PlanFile {
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        toml::from_str(text).map_err(|error| {
            let names: Vec<&str> = error.message().split('`').skip(1).step_by(2).collect();
            let misspelt = error.message().starts_with("unknown ");
            let near = names.split_first().filter(|_| misspelt).and_then(|(given, known)| nearest(given, known.iter().copied()));
            let hint = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
            format!("{}{hint}", syntax(text, &error))
        })
    }

    pub(super) fn inputs(&self) -> Vec<String> {
        match &self.input {
            InputList::One(input) => vec![input.clone()],
            InputList::Several(inputs) => inputs.clone(),
        }
    }

    /// Returns the place of the parameters of all points: the field, and the file if there is one.
    pub(super) fn config_place(&self) -> String {
        match &self.config {
            Some(BaseConfig::File(name)) => format!("config: {name}"),
            _ => "config".into(),
        }
    }

    pub(super) fn objectives(&self) -> Result<Vec<Objective>, String> {
        let objective = |written: &WrittenObjective| match written {
            WrittenObjective::Text(text) => text.parse().map_err(|error| format!("objectives: {error}")),
            WrittenObjective::Fields(ObjectiveFields { figure, goal }) => Ok(Objective {
                column: figure.clone(),
                goal: match goal {
                    WrittenGoal::Min => ObjectiveDirection::Min,
                    WrittenGoal::Max => ObjectiveDirection::Max,
                },
            }),
        };
        self.objectives.iter().map(objective).collect()
    }

    pub(super) fn constraints(&self) -> Result<Vec<Constraint>, String> {
        self.constraints.iter().map(|text| text.parse().map_err(|error| format!("constraints: {error}"))).collect()
    }
}
