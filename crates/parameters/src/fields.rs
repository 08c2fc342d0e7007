//! Configurations as trees of values. One reader and one describer serve every configuration.

use schemars::{Schema, SchemaGenerator};
use serde::{Serialize, de::DeserializeOwned, de::Error as _};
use serde_json::{Error, Map, Value as Json, json};
use std::any::Any;

/// Value of one parameter.
pub trait ParameterValue {
    /// Returns the value as JSON.
    ///
    /// # Errors
    /// A value that JSON cannot represent.
    fn to_json(&self) -> Result<Json, Error>;

    /// Replaces the value.
    ///
    /// # Errors
    /// JSON of another type.
    fn set(&mut self, value: Json) -> Result<(), Error>;
}

impl<T: Serialize + DeserializeOwned + 'static> ParameterValue for T {
    fn to_json(&self) -> Result<Json, Error> {
        match (self as &dyn Any).downcast_ref() {
            Some(single) => Ok(to_decimal(*single)),
            None => serde_json::to_value(self),
        }
    }

    fn set(&mut self, value: Json) -> Result<(), Error> {
        *self = serde_json::from_value(value)?;
        Ok(())
    }
}

/// Returns a number of single precision as it is written: 0.1 and not 0.10000000149011612.
fn to_decimal(single: f32) -> Json {
    single.to_string().parse::<f64>().map_or(Json::Null, Json::from)
}

/// Named fields of a configuration, in order of declaration. The macros implement it.
pub trait Fields {
    /// Returns the fields.
    fn fields(&self) -> Vec<(&'static str, Field<'_>)>;
    /// Returns the fields for modification.
    fn fields_mut(&mut self) -> Vec<(&'static str, FieldMut<'_>)>;
}

/// Field of a configuration.
#[expect(missing_debug_implementations, reason = "values have no text of their own")]
pub enum Field<'a> {
    /// A parameter.
    Value(&'a dyn ParameterValue),
    /// A group of parameters.
    Group(&'a dyn Fields),
}

/// Field of a configuration, for modification.
#[expect(missing_debug_implementations, reason = "values have no text of their own")]
pub enum FieldMut<'a> {
    /// A parameter.
    Value(&'a mut dyn ParameterValue),
    /// A group of parameters.
    Group(&'a mut dyn Fields),
}

/// Returns a configuration as JSON, in groups as in TOML.
///
/// # Errors
/// A value that JSON cannot represent.
pub fn to_json(config: &dyn Fields) -> Result<Json, Error> {
    let field = |(name, field): (&'static str, Field<'_>)| {
        let value = match field {
            Field::Value(value) => value.to_json(),
            Field::Group(group) => to_json(group),
        };
        value.map(|value| (name.to_owned(), value))
    };
    config.fields().into_iter().map(field).collect::<Result<Map<_, _>, _>>().map(Json::Object)
}

/// Reads a configuration that [`to_json`] has written. A missing parameter has its default.
///
/// # Errors
/// An unknown parameter, or a value of another type. Ranges are not checked.
pub fn from_json<C: Fields + Default>(tree: Json) -> Result<C, Error> {
    let mut config = C::default();
    set(&mut config, tree)?;
    Ok(config)
}

fn set(config: &mut dyn Fields, tree: Json) -> Result<(), Error> {
    let Json::Object(given) = tree else { return Err(Error::custom(format!("`{tree}` is a value, expected a table"))) };
    let mut fields = config.fields_mut();
    given.into_iter().try_for_each(|(key, value)| match fields.iter_mut().find(|(name, _)| *name == key) {
        Some((_, FieldMut::Value(field))) => field.set(value),
        Some((_, FieldMut::Group(group))) => set(*group, value),
        None => Err(Error::custom(format!("unknown parameter `{key}`"))),
    })
}

/// Schema of a field, and the lines of its documentation.
pub type FieldSchema<'a> = (&'a [&'a str], fn(&mut SchemaGenerator) -> Schema);

/// Returns the JSON schema of a configuration with this documentation and these defaults.
pub fn schema(generator: &mut SchemaGenerator, about: &[&str], default: &dyn Fields, fields: &[FieldSchema<'_>]) -> Schema {
    let property = |((name, default), (doc, schema)): ((&'static str, Field<'_>), &FieldSchema<'_>)| {
        let mut property = schema(generator);
        let default = match default {
            Field::Value(value) => value.to_json(),
            Field::Group(group) => to_json(group),
        };
        if let Ok(default) = default {
            property.insert("default".into(), default);
        }
        add_description(&mut property, doc);
        (name.to_owned(), property.to_value())
    };
    let properties: Map<_, _> = default.fields().into_iter().zip(fields).map(property).collect();
    let mut schema = Map::from_iter([("type".into(), json!("object")), ("additionalProperties".into(), json!(false))]);
    if !properties.is_empty() {
        schema.insert("properties".into(), Json::Object(properties));
    }
    let mut schema = Schema::from(schema);
    add_description(&mut schema, about);
    schema
}

fn add_description(schema: &mut Schema, doc: &[&str]) {
    let lines: Vec<&str> = doc.iter().map(|line| line.strip_prefix(' ').unwrap_or(line)).collect();
    let text = lines.join("\n");
    if !text.trim().is_empty() {
        schema.insert("description".into(), text.trim().into());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn number_of_single_precision_is_written_as_given() {
        for (single, written) in
            [(0.1_f32, "0.1"), (1e-4, "0.0001"), (1.0 / 510.0, "0.0019607844"), (2.0, "2.0"), (f32::NAN, "null")]
        {
            let json = ParameterValue::to_json(&single).unwrap();
            assert_eq!(json.to_string(), written);
            let mut read = 0.0_f32;
            assert!(read.set(json).is_err() || read == single);
        }
    }
}
