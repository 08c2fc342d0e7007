//! A machine's parameters as data: for `describe --json`, and for whoever puts controls before people.

use crate::machines::MachineConfig;
use basrelief_parameters::Parameter;
use serde::Serialize;
use serde_json::Value;

/// Every fact about a parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Described {
    /// As in `--set KEY=VALUE`.
    pub key: String,
    /// Here.
    pub value: Value,
    /// Of the machine.
    pub default: Value,
    /// Unit of measure; empty for a switch or a choice.
    pub unit: &'static str,
    /// Allowed values in words; empty where [`takes`](Self::takes) says all.
    pub range: String,
    /// What it takes.
    pub takes: Takes,
    /// What it is.
    pub about: String,
    /// `timing` where it changes times only, otherwise `work`.
    pub effect: &'static str,
    /// Where the value comes from.
    pub provenance: From,
}

/// Where a value comes from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct From {
    /// `stated`, `derived` or `assumed`.
    pub kind: &'static str,
    /// The place, derivation or reason.
    pub text: String,
}

/// What a parameter takes.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Takes {
    /// `true` or `false`.
    Switch,
    /// One of these.
    Choice {
        /// Names, as `--set` takes them, with what they mean.
        choices: Vec<Choice>,
    },
    /// A whole number.
    Integer {
        /// The smallest.
        min: f64,
        /// The largest.
        max: f64,
    },
    /// A number.
    Number {
        /// The smallest.
        min: f64,
        /// The largest.
        max: f64,
    },
    /// A text, or a list.
    Text,
}

/// One of several values.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Choice {
    /// As `--set` takes it.
    pub name: String,
    /// What it means.
    pub about: String,
}

impl MachineConfig {
    /// All parameters, in the order of the block diagram, as data.
    pub fn described(&self) -> Vec<Described> {
        let schema = self.machine().schema();
        let defaults = self.machine().parameters();
        let described = |(here, default): (Parameter, &Parameter)| Described {
            takes: takes(&here, &schema),
            key: here.key,
            value: here.default,
            default: default.default.clone(),
            unit: here.unit,
            range: here.range,
            about: here.doc,
            effect: here.effect.name(),
            provenance: From { kind: here.provenance.kind(), text: here.provenance.text().into() },
        };
        self.parameters().into_iter().zip(&defaults).map(described).collect()
    }
}

fn takes(parameter: &Parameter, schema: &Value) -> Takes {
    let named = parameter.key.split('.').try_fold(schema, |at, part| resolved(at, schema).get("properties")?.get(part));
    let named = named.map_or(&Value::Null, |named| resolved(named, schema));
    if let Some(choices) = named.get("oneOf").and_then(Value::as_array) {
        return Takes::Choice { choices: choices.iter().filter_map(choice).collect() };
    }
    match (&parameter.default, bounds(&parameter.range)) {
        (Value::Bool(_), _) => Takes::Switch,
        (Value::Number(n), Some([min, max])) if n.is_f64() => Takes::Number { min, max },
        (Value::Number(_), Some([min, max])) => Takes::Integer { min, max },
        _ => Takes::Text,
    }
}

/// What a part of a schema refers to, or itself.
fn resolved<'a>(part: &'a Value, schema: &'a Value) -> &'a Value {
    let place = part.get("$ref").and_then(Value::as_str).and_then(|place| place.strip_prefix('#'));
    place.and_then(|place| schema.pointer(place)).unwrap_or(part)
}

fn choice(one: &Value) -> Option<Choice> {
    let text = |key| one.get(key).and_then(Value::as_str);
    Some(Choice { name: text("const")?.into(), about: text("description").unwrap_or_default().into() })
}

/// The ends of a range as it is written: `1..=64`, and of the first where there are several.
pub(crate) fn bounds(range: &str) -> Option<[f64; 2]> {
    let (min, rest) = range.split_once("..=")?;
    let max = rest.split(|c: char| c == ',' || c.is_whitespace()).next()?;
    Some([min.parse().ok()?, max.parse().ok()?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machines::MACHINES;

    fn of(machine: usize, key: &str) -> Described {
        let config = MACHINES[machine].load("", &[]).unwrap();
        config.described().into_iter().find(|p| p.key == key).unwrap()
    }

    #[test]
    fn what_a_parameter_takes_is_told_as_data() {
        assert_eq!(of(0, "replacement.lanes").takes, Takes::Integer { min: 1.0, max: 65536.0 });
        assert_eq!(of(0, "replacement.entries").takes, Takes::Integer { min: 1.0, max: 65536.0 });
        assert_eq!(of(0, "depth.clear_flags").takes, Takes::Switch);
        assert_eq!(of(0, "ideal.units").takes, Takes::Text);
        assert!(matches!(of(1, "shade.ia").takes, Takes::Number { min: 0.0, .. }));
        let Takes::Choice { choices } = of(0, "memory.graphics.part").takes else { panic!("no choice") };
        assert!(choices.iter().any(|c| c.name == "ddr-400" && !c.about.is_empty()));
    }

    #[test]
    fn every_number_has_ends_and_every_choice_its_default() {
        for machine in MACHINES {
            for Described { key, default, takes, .. } in machine.load("", &[]).unwrap().described() {
                match takes {
                    Takes::Choice { choices } => assert!(choices.iter().any(|c| default == c.name), "{key}"),
                    Takes::Integer { min, max } | Takes::Number { min, max } => {
                        assert!((min..=max).contains(&default.as_f64().unwrap()), "{key}");
                    }
                    Takes::Switch => assert!(default.is_boolean(), "{key}"),
                    Takes::Text => assert!(default.is_string() || default.is_array(), "{key} is {default}"),
                }
            }
        }
    }
}
