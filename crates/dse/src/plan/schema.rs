//! JSON schema of a plan.

use super::axes::RangeSteps;
use super::written::PlanFile;
use basrelief_signals::{resolve_reference, schema_of};
use basrelief_sim::{MACHINES, MachineInfo};
use serde_json::{Map, Value, json};

/// Returns the JSON schema (2020-12) of a plan for a machine: its parameters are the axes. `view` is the schema of the view options,
/// which the host of the sweep knows.
pub fn plan_schema(machine: &MachineInfo, view: &Value) -> Value {
    let mut plan = schema_of::<PlanFile>(&format!("plan-{}", machine.name)).to_value();
    let mut config = machine.schema();
    let whole = json!({ "properties": config["properties"].take(), "additionalProperties": false });
    let axes = of_groups(
        &whole,
        &config,
        &|parameter| json!({ "anyOf": [{ "type": "array", "items": parameter, "minItems": 1 }, { "$ref": "#/$defs/Range" }] }),
    );
    let excluded =
        of_groups(&whole, &config, &|parameter| json!({ "anyOf": [parameter, { "type": "array", "items": parameter }] }));
    let properties = &mut plan["properties"];
    properties["machine"] = json!({ "enum": MACHINES.iter().map(|m| m.name).collect::<Vec<_>>(), "description": "Machine." });
    describe(&mut properties["config"], json!({ "anyOf": [{ "type": "string" }, { "$ref": "#/$defs/Configuration" }] }));
    for (name, schema) in [("view", view), ("axes", &axes)] {
        describe(&mut properties[name], schema.clone());
    }
    for (name, schema) in [("views", view), ("zip", &axes), ("exclude", &excluded)] {
        properties[name]["items"] = schema.clone();
    }
    let mut kept = config["$defs"].take();
    merge(&mut kept, plan["$defs"].take());
    kept["Configuration"] = whole;
    kept["Range"] = schema_of::<RangeSteps>("range").to_value();
    plan["$defs"] = kept;
    plan
}

/// Replaces a schema. Its description stays.
fn describe(property: &mut Value, schema: Value) {
    let description = property["description"].take();
    *property = schema;
    property["description"] = description;
}

fn merge(into: &mut Value, from: Value) {
    if let (Some(into), Value::Object(from)) = (into.as_object_mut(), from) {
        into.extend(from);
    }
}

/// Returns the schema of a table with the groups of a configuration, whose parameters have another schema.
///
/// A key in quotes, such as `"replacement.lanes"`, may name a parameter in a group.
fn of_groups(group: &Value, config: &Value, of_parameter: &dyn Fn(&Value) -> Value) -> Value {
    let group = resolve_reference(group, config);
    let mut properties = Map::new();
    for (name, property) in group["properties"].as_object().into_iter().flatten() {
        let schema = match resolve_reference(property, config) {
            inner if inner.get("properties").is_some() => of_groups(inner, config, of_parameter),
            _ => {
                let mut schema = of_parameter(property);
                schema["description"] = property["description"].clone();
                schema
            }
        };
        properties.insert(name.clone(), schema);
    }
    json!({ "type": "object", "properties": properties, "patternProperties": { "[.]": {} }, "additionalProperties": false })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(plan: &str) -> Vec<String> {
        let plan: toml::Table = plan.parse().unwrap();
        let machine = plan.get("machine").and_then(toml::Value::as_str).unwrap_or("bump");
        let view = json!({ "type": "object" });
        let validator = jsonschema::validator_for(&plan_schema(MachineInfo::named(machine).unwrap(), &view)).unwrap();
        validator.iter_errors(&serde_json::to_value(plan).unwrap()).map(|error| error.to_string()).collect()
    }

    const HEAD: &str =
        "input = \"demo:golf-ball\"\nobjectives = [\"cycles min\", { figure = \"quality.psnr_db\", goal = \"max\" }]\n";

    #[test]
    fn schema_accepts_axes_and_refuses_wrong_ones() {
        for (axes, is_valid) in [
            ("[axes]\nreplacement.lanes = [16, 64]", true),
            ("[axes]\n\"replacement.lanes\" = [16, 64]", true),
            ("[axes]\nreplacement.lanes = { from = 2, to = 64, factor = 2 }", true),
            ("[[zip]]\nreplacement.lanes = [16, 64]\nreplacement.entries = [64, [64, 32]]", true),
            ("[axes]\nreplacement.entries = [16, 64]\n[[exclude]]\nreplacement.entries = 16", true),
            ("[config]\nreplacement.lanes = 16", true),
            ("[axes]\nreplacement.lane = [16, 64]", false),
            ("[axes]\nreplacement.lanes = [0]", false),
            ("[axes]\nreplacement.lanes = []", false),
            ("[axes]\nreplacement.lanes = { from = 2, to = 64, by = 2 }", false),
            ("[config]\nreplacement.lanes = 0", false),
            ("[samples]\nmethod = \"random\"", false),
        ] {
            let errors = errors(&format!("{HEAD}{axes}"));
            assert_eq!(errors.is_empty(), is_valid, "{axes}: {errors:?}");
        }
        assert!(!errors("objectives = []").is_empty());
    }

    #[test]
    fn studies_match_the_schema() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../studies");
        let plans = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let plans: Vec<_> = plans.filter(|path| path.extension().is_some_and(|end| end == "toml")).collect();
        assert!(plans.len() > 5);
        for path in plans {
            let text = std::fs::read_to_string(&path).unwrap();
            assert_eq!(errors(&text), Vec::<String>::new(), "{}", path.display());
        }
    }
}
