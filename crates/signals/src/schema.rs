//! JSON schemas that strict validators accept.

use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema};
use serde_json::Value;

/// Returns the JSON schema (2020-12) of a type.
///
/// The schema has no `format`, because JSON Schema defines no formats of numbers and validators such as Ajv refuse unknown formats.
/// Integers of up to 32 bits have `minimum` and `maximum` instead. Descriptions have square brackets without the backslashes of rustdoc.
pub fn schema_of<T: JsonSchema>(name: &str) -> Schema {
    let settings = SchemaSettings::draft2020_12().with_transform(RecursiveTransform(make_portable));
    let mut schema = settings.into_generator().into_root_schema_for::<T>();
    schema.insert("$id".into(), format!("urn:basrelief:schema:{name}").into());
    schema
}

/// Returns the JSON pointer of a reference (`$ref`) to another part of the same schema; `None` if the part is no such reference.
pub fn reference_pointer(part: &Value) -> Option<&str> {
    part.get("$ref")?.as_str()?.strip_prefix('#')
}

/// Returns the part of a schema that a reference names; otherwise the part itself.
pub fn resolve_reference<'a>(part: &'a Value, schema: &'a Value) -> &'a Value {
    reference_pointer(part).and_then(|pointer| schema.pointer(pointer)).unwrap_or(part)
}

fn make_portable(schema: &mut Schema) {
    replace_format(schema);
    // A property that is called `description` has a schema and not a text.
    if let Some(text) = schema.get("description").and_then(Value::as_str) {
        let text = text.replace("\\[", "[").replace("\\]", "]");
        schema.insert("description".into(), text.into());
    }
}

/// Replaces the format of a number by its range. Wider types have no range, because JSON readers may round such limits.
fn replace_format(schema: &mut Schema) {
    // A property that is called `format` has a schema and not a name.
    let Some(format) = schema.get("format").and_then(|format| format.as_str()).map(str::to_owned) else { return };
    schema.remove("format");
    let range: Option<[i64; 2]> = match format.as_str() {
        "uint8" => Some([0, u8::MAX.into()]),
        "uint16" => Some([0, u16::MAX.into()]),
        "uint32" => Some([0, u32::MAX.into()]),
        "int8" => Some([i8::MIN.into(), i8::MAX.into()]),
        "int16" => Some([i16::MIN.into(), i16::MAX.into()]),
        "int32" => Some([i32::MIN.into(), i32::MAX.into()]),
        _ => None,
    };
    for (name, limit) in ["minimum", "maximum"].into_iter().zip(range.into_iter().flatten()) {
        if schema.get(name).is_none() {
            schema.insert(name.into(), limit.into());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(JsonSchema)]
    #[allow(dead_code)]
    struct Numbers {
        small: u8,
        word: Option<u32>,
        signed: i32,
        /// Size \[bits\].
        wide: u64,
        real: f64,
        #[schemars(range(min = 1, max = 9))]
        limited: u32,
        format: Vec<f32>,
    }

    #[test]
    fn references_lead_to_their_part() {
        let schema =
            serde_json::json!({ "$defs": { "A": { "type": "array" } }, "a": { "$ref": "#/$defs/A" }, "b": { "$ref": "#/c" } });
        assert_eq!(resolve_reference(&schema["a"], &schema), &schema["$defs"]["A"]);
        assert_eq!(resolve_reference(&schema["$defs"]["A"], &schema), &schema["$defs"]["A"]);
        assert_eq!(resolve_reference(&schema["b"], &schema), &schema["b"], "a part that does not exist");
        assert_eq!(reference_pointer(&schema["a"]), Some("/$defs/A"));
    }

    #[test]
    fn descriptions_have_plain_brackets() {
        let schema = schema_of::<Numbers>("numbers").to_value();
        assert_eq!(schema["properties"]["wide"]["description"], "Size [bits].");
    }

    #[test]
    fn formats_of_numbers_become_ranges() {
        let schema = schema_of::<Numbers>("numbers").to_value();
        assert_eq!(schema["$id"], "urn:basrelief:schema:numbers");
        let of = |name: &str| schema["properties"][name].clone();
        let range = |name: &str| (of(name)["minimum"].as_f64(), of(name)["maximum"].as_f64());
        assert_eq!(range("small"), (Some(0.0), Some(255.0)));
        assert_eq!(range("word"), (Some(0.0), Some(4_294_967_295.0)));
        assert_eq!(range("signed"), (Some(-2_147_483_648.0), Some(2_147_483_647.0)));
        assert_eq!(range("limited"), (Some(1.0), Some(9.0)));
        assert_eq!((range("wide"), range("real")), ((Some(0.0), None), (None, None)));
        assert_eq!(of("format")["items"]["type"], "number");
        assert!(!schema.to_string().contains("\"format\":\""), "{schema}");
    }
}
