//! Functions that the macros call, so that the code of each declaration is small.

use crate::error::allowed;
use crate::fields::{ParameterValue, from_json, to_json};
use crate::{Effect, Parameter, Provenance, RangeError, value_of};
use serde::de::value::MapAccessDeserializer;
use serde::de::{self, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer, ser};
use serde_json::Value as Json;
use std::fmt::{self, Debug};

pub use crate::fields::{Field, FieldMut, FieldSchema, Fields, schema};
pub use {schemars, serde};

/// Appends a parameter to a table.
pub fn add_parameter(
    table: &mut Vec<Parameter>,
    (key, doc, unit): (&str, &str, &'static str),
    range: Option<&dyn Debug>,
    default: &dyn ParameterValue,
    (provenance, effect): (Provenance, Effect),
) {
    table.push(Parameter {
        key: key.into(),
        doc: doc.trim().into(),
        unit,
        range: range.map(|range| format!("{range:?}")).unwrap_or_default(),
        default: default.to_json().unwrap_or_default(),
        provenance,
        effect,
    });
}

/// Appends the parameters of a group to a table. `defaults` are those of the whole configuration. `provenances` replace those of the
/// group's parameters with these names.
pub fn add_group(
    table: &mut Vec<Parameter>,
    name: &str,
    group: Vec<Parameter>,
    defaults: &Json,
    provenances: &[(&[&str], Provenance)],
) {
    for mut parameter in group {
        if let Some(default) = value_of(&defaults[name], &parameter.key) {
            parameter.default = default.clone();
        }
        for (_, provenance) in provenances.iter().filter(|(inner, _)| inner.join(".") == parameter.key) {
            parameter.provenance = provenance.clone();
        }
        parameter.key = format!("{name}.{}", parameter.key);
        table.push(parameter);
    }
}

/// Serializes a configuration through JSON.
///
/// # Errors
/// A value that JSON cannot represent, or errors of the serializer.
pub fn serialize<S: Serializer>(config: &dyn Fields, serializer: S) -> Result<S::Ok, S::Error> {
    to_json(config).map_err(ser::Error::custom)?.serialize(serializer)
}

/// Deserializes a configuration with these fields through JSON. Within a flattened field it ignores other keys, as serde does.
///
/// # Errors
/// Errors of [`from_json`] and of the deserializer.
pub fn deserialize<'de, C: Fields + Default, D: Deserializer<'de>>(
    deserializer: D,
    name: &'static str,
    fields: &'static [&'static str],
) -> Result<C, D::Error> {
    from_json(deserializer.deserialize_struct(name, fields, TreeVisitor(name))?).map_err(de::Error::custom)
}

/// Visitor that collects a map as JSON.
struct TreeVisitor(&'static str);

impl<'de> Visitor<'de> for TreeVisitor {
    type Value = Json;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "struct {}", self.0)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Json, A::Error> {
        Json::deserialize(MapAccessDeserializer::new(map))
    }
}

/// Returns the prefix of the keys of a group.
pub fn group_prefix(prefix: &str, name: &str) -> String {
    format!("{prefix}{name}.")
}

/// Returns the error of a value outside its range.
pub fn range_error<T: ParameterValue + Debug>(prefix: &str, key: &str, value: &T, range: &dyn Debug, unit: &str) -> RangeError {
    range_error_of(prefix, key, value.to_json().unwrap_or_default(), value, range, unit)
}

fn range_error_of(prefix: &str, key: &str, json: Json, value: &dyn Debug, range: &dyn Debug, unit: &str) -> RangeError {
    let value = match json {
        // Non-finite numbers have no JSON.
        Json::Null => format!("{value:?}"),
        json => json.to_string(),
    };
    RangeError { key: format!("{prefix}{key}"), value, expected: allowed(&format!("{range:?}"), unit) }
}
