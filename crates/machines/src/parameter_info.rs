//! Parameters of a machine as data, for `describe --json` and for user interfaces.

use crate::configuration_schema::bounds;
use crate::registry::MachineConfig;
use basrelief_parameters::Parameter;
use basrelief_signals::resolve_reference;
use serde::Serialize;
use serde_json::Value;

/// Description of a parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterInfo {
    /// Key, as in `--set KEY=VALUE`.
    pub key: String,
    /// Value in this configuration.
    pub value: Value,
    /// Default value of the machine.
    pub default: Value,
    /// Unit of measure; empty for a switch or a choice.
    pub unit: &'static str,
    /// Allowed values as text; empty if [`takes`](Self::takes) is complete.
    pub range: String,
    /// Allowed values.
    pub takes: AllowedValues,
    /// Meaning.
    pub about: String,
    /// `work`, `timing` or `cost`: the part of a run that the parameter changes.
    pub effect: &'static str,
    /// Source of the value.
    pub provenance: ValueSource,
}

/// Source of a value.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ValueSource {
    /// `stated`, `derived` or `assumed`.
    pub kind: &'static str,
    /// Place in the patent, derivation or reason.
    pub text: String,
}

/// Allowed values of a parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum AllowedValues {
    /// `true` or `false`.
    Switch,
    /// One of several names.
    Choice {
        /// The names, with their meanings.
        choices: Vec<ParameterChoice>,
    },
    /// An integer.
    Integer {
        /// Minimum.
        min: f64,
        /// Maximum.
        max: f64,
    },
    /// A number.
    Number {
        /// Minimum.
        min: f64,
        /// Maximum.
        max: f64,
    },
    /// A text or a list.
    Text,
}

/// One of several names.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ParameterChoice {
    /// Name, as in `--set`.
    pub name: String,
    /// Meaning.
    pub about: String,
}

impl MachineConfig {
    /// Returns descriptions of all parameters, in the order of the block diagram.
    pub fn described(&self) -> Vec<ParameterInfo> {
        let schema = self.machine().schema();
        let defaults = self.machine().parameters();
        let described = |(here, default): (Parameter, &Parameter)| ParameterInfo {
            takes: takes(&here, &schema),
            key: here.key,
            value: here.default,
            default: default.default.clone(),
            unit: here.unit,
            range: here.range,
            about: here.doc,
            effect: here.effect.name(),
            provenance: ValueSource { kind: here.provenance.kind(), text: here.provenance.text().into() },
        };
        self.parameters().into_iter().zip(&defaults).map(described).collect()
    }
}

fn takes(parameter: &Parameter, schema: &Value) -> AllowedValues {
    let named = parameter.key.split('.').try_fold(schema, |at, part| resolve_reference(at, schema).get("properties")?.get(part));
    let named = named.map_or(&Value::Null, |named| resolve_reference(named, schema));
    if let Some(choices) = named.get("oneOf").and_then(Value::as_array) {
        return AllowedValues::Choice { choices: choices.iter().filter_map(choice).collect() };
    }
    match (&parameter.default, bounds(&parameter.range)) {
        (Value::Bool(_), _) => AllowedValues::Switch,
        (Value::Number(n), Some([min, max])) if n.is_f64() => AllowedValues::Number { min, max },
        (Value::Number(_), Some([min, max])) => AllowedValues::Integer { min, max },
        _ => AllowedValues::Text,
    }
}

fn choice(one: &Value) -> Option<ParameterChoice> {
    let text = |key| one.get(key).and_then(Value::as_str);
    Some(ParameterChoice { name: text("const")?.into(), about: text("description").unwrap_or_default().into() })
}
