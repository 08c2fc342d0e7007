//! Ranges of parameters in the JSON schema of a configuration. The types alone give none.

use basrelief_parameters::Parameter;
use basrelief_signals::reference_pointer;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Adds the range of each number. Groups may share a definition: a property then has a range that contains all of theirs.
pub fn with_ranges(mut schema: Value, parameters: &[Parameter]) -> Value {
    let mut ranges = BTreeMap::<String, [f64; 2]>::new();
    for parameter in parameters {
        let place = pointer_to(&schema, &parameter.key);
        let (Some(place), Some([min, max])) = (place, bounds(&parameter.range)) else { continue };
        let range = ranges.entry(place).or_insert([min, max]);
        *range = [range[0].min(min), range[1].max(max)];
    }
    for (place, [min, max]) in ranges {
        let Some(property) = schema.pointer_mut(&place) else { continue };
        let is_integer = property["type"] == "integer";
        if is_integer || property["type"] == "number" {
            property["minimum"] = number(min, is_integer);
            property["maximum"] = number(max, is_integer);
        }
    }
    schema
}

/// Returns the JSON pointer to a parameter's property. It follows the references of the groups.
fn pointer_to(schema: &Value, key: &str) -> Option<String> {
    key.split('.').try_fold(String::new(), |at, part| {
        let group = reference_pointer(schema.pointer(&at)?).unwrap_or(&at);
        let property = format!("{group}/properties/{part}");
        schema.pointer(&property).is_some().then_some(property)
    })
}

/// Parses the first range in a text such as `1..=64`.
pub fn bounds(range: &str) -> Option<[f64; 2]> {
    let (min, rest) = range.split_once("..=")?;
    let max = rest.split(|c: char| c == ',' || c.is_whitespace()).next()?;
    Some([min.parse().ok()?, max.parse().ok()?])
}

/// Returns a limit, without a fraction for an integer.
fn number(limit: f64, is_integer: bool) -> Value {
    if is_integer { json!(limit as i64) } else { json!(limit) }
}
