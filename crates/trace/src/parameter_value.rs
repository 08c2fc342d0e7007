//! Values of parameters, as expectations hold them.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;
use std::fmt;

/// A single value.
#[derive(Clone, Debug, PartialEq)]
pub enum ScalarValue {
    /// A switch.
    Bool(bool),
    /// A whole number.
    Integer(i64),
    /// Any other number, finite.
    Number(f64),
    /// A choice.
    Text(String),
}

/// Value of a parameter in an expectation. [`Display`](fmt::Display) writes it as TOML, as `--set` takes it.
///
/// Lists hold no lists: no parameter needs it, and a reader of untrusted bytes that recursed could be driven out of
/// its stack.
#[derive(Clone, Debug, PartialEq)]
pub enum ParameterValue {
    /// One value.
    One(ScalarValue),
    /// One value per level.
    List(Vec<ScalarValue>),
}

impl ParameterValue {
    /// Returns the allocated memory \[bytes\]. Lists count twice, because they grow by doubling.
    pub(crate) fn bytes(&self) -> usize {
        let text = |scalar: &ScalarValue| if let ScalarValue::Text(text) = scalar { 32 + text.len() } else { 0 };
        match self {
            Self::One(scalar) => text(scalar),
            Self::List(list) => 2 * size_of_val(&**list) + list.iter().map(text).sum::<usize>(),
        }
    }

    pub(crate) fn is_finite(&self) -> bool {
        let finite = |scalar: &ScalarValue| !matches!(scalar, ScalarValue::Number(number) if !number.is_finite());
        match self {
            Self::One(scalar) => finite(scalar),
            Self::List(list) => list.iter().all(finite),
        }
    }
}

impl fmt::Display for ScalarValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bool(value) => write!(f, "{value}"),
            Self::Integer(value) => write!(f, "{value}"),
            Self::Number(value) => write!(f, "{value:?}"),
            Self::Text(value) => write_toml_string(f, value),
        }
    }
}

impl fmt::Display for ParameterValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::One(scalar) => write!(f, "{scalar}"),
            Self::List(list) => {
                f.write_str("[")?;
                for (i, value) in list.iter().enumerate() {
                    write!(f, "{}{value}", if i == 0 { "" } else { ", " })?;
                }
                f.write_str("]")
            }
        }
    }
}

fn write_toml_string(f: &mut fmt::Formatter<'_>, text: &str) -> fmt::Result {
    f.write_str("\"")?;
    for c in text.chars() {
        match c {
            '"' | '\\' => write!(f, "\\{c}")?,
            _ if c.is_control() => write!(f, "\\u{:04x}", u32::from(c))?,
            _ => write!(f, "{c}")?,
        }
    }
    f.write_str("\"")
}

/// The binary form does not describe itself, so there a scalar is an ordinary enum, and a value says whether it is
/// a list.
#[derive(Serialize, Deserialize)]
enum TaggedValue<'a> {
    Bool(bool),
    Integer(i64),
    Number(f64),
    Text(Cow<'a, str>),
}

impl Serialize for ScalarValue {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match (self, serializer.is_human_readable()) {
            (Self::Bool(value), true) => value.serialize(serializer),
            (Self::Integer(value), true) => value.serialize(serializer),
            (Self::Number(value), true) => value.serialize(serializer),
            (Self::Text(value), true) => value.serialize(serializer),
            (Self::Bool(value), false) => TaggedValue::Bool(*value).serialize(serializer),
            (Self::Integer(value), false) => TaggedValue::Integer(*value).serialize(serializer),
            (Self::Number(value), false) => TaggedValue::Number(*value).serialize(serializer),
            (Self::Text(value), false) => TaggedValue::Text(value.into()).serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for ScalarValue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if deserializer.is_human_readable() {
            return deserializer.deserialize_any(ScalarVisitor);
        }
        Ok(match TaggedValue::deserialize(deserializer)? {
            TaggedValue::Bool(value) => Self::Bool(value),
            TaggedValue::Integer(value) => Self::Integer(value),
            TaggedValue::Number(value) => Self::Number(value),
            TaggedValue::Text(value) => Self::Text(value.into_owned()),
        })
    }
}

impl Serialize for ParameterValue {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match (self, serializer.is_human_readable()) {
            (Self::One(scalar), true) => scalar.serialize(serializer),
            (Self::List(list), true) => list.serialize(serializer),
            (Self::One(scalar), false) => (false, std::slice::from_ref(scalar)).serialize(serializer),
            (Self::List(list), false) => (true, list).serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for ParameterValue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if deserializer.is_human_readable() {
            return deserializer.deserialize_any(ParameterValueVisitor);
        }
        let (is_list, mut items) = <(bool, Vec<ScalarValue>)>::deserialize(deserializer)?;
        match (is_list, items.len(), items.pop()) {
            (false, 1, Some(scalar)) => Ok(Self::One(scalar)),
            (false, count, _) => Err(D::Error::custom(format_args!("{count} values, expected one"))),
            (true, _, last) => {
                items.extend(last);
                Ok(Self::List(items))
            }
        }
    }
}

struct ScalarVisitor;

impl Visitor<'_> for ScalarVisitor {
    type Value = ScalarValue;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a switch, a number or a text")
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<ScalarValue, E> {
        Ok(ScalarValue::Bool(value))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<ScalarValue, E> {
        Ok(ScalarValue::Integer(value))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<ScalarValue, E> {
        let out_of_range = |_| E::custom(format_args!("{value} is too large, expected at most {}", i64::MAX));
        i64::try_from(value).map(ScalarValue::Integer).map_err(out_of_range)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<ScalarValue, E> {
        Ok(ScalarValue::Number(value))
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<ScalarValue, E> {
        Ok(ScalarValue::Text(value.into()))
    }
}

struct ParameterValueVisitor;

impl<'de> Visitor<'de> for ParameterValueVisitor {
    type Value = ParameterValue;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a switch, a number, a text, or a list of these")
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<ParameterValue, E> {
        ScalarVisitor.visit_bool(value).map(ParameterValue::One)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<ParameterValue, E> {
        ScalarVisitor.visit_i64(value).map(ParameterValue::One)
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<ParameterValue, E> {
        ScalarVisitor.visit_u64(value).map(ParameterValue::One)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<ParameterValue, E> {
        ScalarVisitor.visit_f64(value).map(ParameterValue::One)
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<ParameterValue, E> {
        ScalarVisitor.visit_str(value).map(ParameterValue::One)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<ParameterValue, A::Error> {
        let mut list = Vec::new();
        while let Some(item) = items.next_element()? {
            list.push(item);
        }
        Ok(ParameterValue::List(list))
    }
}

impl JsonSchema for ParameterValue {
    fn schema_name() -> Cow<'static, str> {
        "ParameterValue".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "Value of a parameter: a switch, a number, a text, or a list of these.",
            "type": ["boolean", "number", "string", "array"],
            "items": { "type": ["boolean", "number", "string"] }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameter_value_is_written_as_toml() {
        let value: ParameterValue = serde_json::from_str(r#"[256, 0.5, "a\"b\n", true]"#).unwrap();
        assert_eq!(value.to_string(), r#"[256, 0.5, "a\"b\u000a", true]"#);
    }

    #[test]
    fn integer_beyond_64_bits_is_refused() {
        assert!(serde_json::from_str::<ParameterValue>("18446744073709551615").is_err());
        assert!(serde_json::from_str::<ParameterValue>("null").is_err());
        assert!(serde_json::from_str::<ParameterValue>("[[1]]").is_err());
    }
}
