//! A plan as it is written.

use crate::{Constraint, Objective, ObjectiveDirection};
use basrelief_parameters::TomlFault;
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::{Map, Value};
use std::fmt::Display;
use std::num::NonZeroU64;
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
    /// Views of each point, over `view`; at least one. Each draws one frame unless it states more.
    #[schemars(with = "Option<Vec<Map<String, Value>>>", length(min = 1))]
    pub(super) views: Option<Vec<Table>>,
    /// Cycles after which a run stops.
    pub(super) max_cycles: Option<NonZeroU64>,
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
    #[schemars(with = "Vec<WrittenObjective>")]
    pub(super) objectives: Vec<toml::Value>,
    /// Conditions of a fit point, such as `quality.psnr_db >= 30`.
    #[serde(default)]
    pub(super) constraints: Vec<String>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected the name of an input, such as \"demo:golf-ball\", or a list of them")]
pub(super) enum InputList {
    One(String),
    Several(#[schemars(with = "Vec<String>")] Vec<toml::Value>),
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

impl ObjectiveFields {
    fn objective(self) -> Objective {
        let goal = match self.goal {
            WrittenGoal::Min => ObjectiveDirection::Min,
            WrittenGoal::Max => ObjectiveDirection::Max,
        };
        Objective { column: self.figure, goal }
    }
}

/// Fields that every plan has, each with its expectation and an example.
const REQUIRED: [(&str, &str, &str); 2] = [
    ("input", "the name of an input, or a list of them", "\"demo:golf-ball\""),
    ("objectives", "a list of figures with their goals", "[\"cycles min\"]"),
];

impl PlanFile {
    pub(super) fn parse(text: &str) -> Result<Self, TomlFault> {
        toml::from_str(text).map_err(|error: toml::de::Error| {
            let missing = error.message().strip_prefix("missing field ").unwrap_or_default();
            match REQUIRED.iter().find(|(field, ..)| missing == format!("`{field}`")) {
                Some((field, expected, example)) => TomlFault::new(
                    &[""; 0],
                    format!("{field}: is missing; expected {expected}; add for example {field} = {example}"),
                ),
                None => TomlFault::of_reader(text, &error),
            }
        })
    }

    /// Returns the inputs, each with its path in the plan.
    pub(super) fn inputs(&self) -> Result<Vec<(Vec<String>, String)>, TomlFault> {
        let input = |(number, value): (usize, &toml::Value)| match value.as_str() {
            Some(input) => Ok((vec!["input".into(), number.to_string()], input.to_owned())),
            None => {
                let message = format!("is {value}, expected the name of an input, such as \"demo:golf-ball\"");
                Err(fault_in("input", number, message))
            }
        };
        match &self.input {
            InputList::One(input) => Ok(vec![(vec!["input".into()], input.clone())]),
            InputList::Several(inputs) => inputs.iter().enumerate().map(input).collect(),
        }
    }

    /// Returns the place of the parameters of all points: the field, and the file if there is one.
    pub(super) fn config_place(&self) -> String {
        match &self.config {
            Some(BaseConfig::File(name)) => format!("config: {name}"),
            _ => "config".into(),
        }
    }

    pub(super) fn objectives(&self) -> Result<Vec<Objective>, TomlFault> {
        let objective = |(number, value): (usize, &toml::Value)| {
            // The reader gives elements of lists that fit no alternative no place.
            let written = WrittenObjective::deserialize(value.clone());
            match written.map_err(|error| fault_in("objectives", number, error.message()))? {
                WrittenObjective::Text(text) => text.parse().map_err(|error| fault_in("objectives", number, error)),
                WrittenObjective::Fields(fields) => Ok(fields.objective()),
            }
        };
        self.objectives.iter().enumerate().map(objective).collect()
    }

    pub(super) fn constraints(&self) -> Result<Vec<Constraint>, TomlFault> {
        let constraint = |(number, text): (usize, &String)| text.parse().map_err(|error| fault_in("constraints", number, error));
        self.constraints.iter().enumerate().map(constraint).collect()
    }
}

/// Returns the error of an element of a list.
pub(super) fn fault_in(list: &str, number: usize, error: impl Display) -> TomlFault {
    TomlFault::new(&[list, &number.to_string()], format!("{list}: {error}"))
}
