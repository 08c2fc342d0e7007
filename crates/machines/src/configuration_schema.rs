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

#[cfg(test)]
mod tests {
    use crate::registry::MACHINES;
    use serde_json::{Value, json};

    #[test]
    fn schema_refuses_values_out_of_range() {
        let validator = jsonschema::validator_for(&MACHINES[0].schema()).unwrap();
        for (config, is_valid) in [
            (json!({ "replacement": { "lanes": 64 } }), true),
            (json!({ "replacement": { "lanes": 0 } }), false),
            (json!({ "replacement": { "lanes": 65537 } }), false),
            (json!({ "fifo": { "pixels": { "depth": 0 } } }), false),
            (json!({ "memory": { "graphics": { "part": "ddr-400" } } }), true),
            (json!({ "memory": { "graphics": { "part": "ddr-4000" } } }), false),
        ] {
            assert_eq!(validator.is_valid(&config), is_valid, "{config}");
        }
    }

    #[test]
    fn default_configurations_match_their_schemas() {
        for machine in MACHINES {
            let validator = jsonschema::validator_for(&machine.schema()).unwrap();
            let config: Value = machine.load("", &[]).unwrap().to_value();
            let errors: Vec<String> = validator.iter_errors(&config).map(|error| error.to_string()).collect();
            assert!(errors.is_empty(), "{}: {errors:?}", machine.name);
        }
    }
}
