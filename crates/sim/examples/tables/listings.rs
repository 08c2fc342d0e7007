//! Listings that are files of their own: every parameter of every machine, and every key of a report.

use basrelief_parameters::Parameter;
use basrelief_signals::resolve_reference;
use basrelief_sim::MACHINES;
use serde_json::Value;
use std::error::Error;

/// Makes a listing, as CSV.
type Make = fn() -> Result<String, Box<dyn Error>>;

/// All listings, by file.
pub const LISTINGS: [(&str, Make); 2] =
    [("docs/reference/parameters.csv", parameters), ("docs/reference/report-keys.csv", report_keys)];

/// Rows as CSV with a heading.
fn csv(heading: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> Result<String, Box<dyn Error>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(heading)?;
    for row in rows {
        writer.write_record(row)?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}

/// Parameters that all machines with the key describe alike share a row.
fn parameters() -> Result<String, Box<dyn Error>> {
    let mut rows: Vec<(String, Vec<String>)> = Vec::new();
    for machine in MACHINES {
        for parameter in machine.parameters() {
            let row = facts(&parameter);
            match rows.iter_mut().find(|(_, known)| *known == row) {
                Some((machines, _)) => machines.extend([" ", machine.name]),
                None => rows.push((machine.name.to_owned(), row)),
            }
        }
    }
    let heading = ["machines", "key", "default", "unit", "range", "effect", "provenance", "source", "meaning"];
    csv(&heading, rows.into_iter().map(|(machines, row)| [vec![machines], row].concat()))
}

/// Every fact about a parameter, in the order of the columns.
fn facts(p: &Parameter) -> Vec<String> {
    let (kind, source) = (p.provenance.kind(), p.provenance.text());
    [&p.key, &p.as_option(), p.unit, &p.range, p.effect.name(), kind, source, &p.doc].map(str::to_owned).into()
}

fn report_keys() -> Result<String, Box<dyn Error>> {
    let schema = basrelief_report::schema();
    let mut rows = Vec::new();
    walk(&schema, &schema, "", &mut rows);
    csv(&["key", "type", "meaning"], rows)
}

/// Adds a row for each key below a part of the schema: names of a map as `NAME`, items of a list as `[]`.
fn walk(schema: &Value, part: &Value, path: &str, rows: &mut Vec<Vec<String>>) {
    let part = resolved(schema, part);
    for (key, value) in part["properties"].as_object().into_iter().flatten() {
        let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        let meaning = value["description"].as_str().unwrap_or_default().replace('\n', " ");
        rows.push(vec![path.clone(), type_of(schema, value), meaning]);
        walk(schema, value, &path, rows);
    }
    if part["additionalProperties"].is_object() {
        walk(schema, &part["additionalProperties"], &format!("{path}.NAME"), rows);
    }
    if part["items"].is_object() {
        walk(schema, &part["items"], &format!("{path}[]"), rows);
    }
}

/// A part of the schema with references followed; of a choice the one that is not null.
fn resolved<'a>(schema: &'a Value, part: &'a Value) -> &'a Value {
    let choices = part["anyOf"].as_array().into_iter().flatten();
    let part = choices.into_iter().find(|choice| choice["type"] != "null").unwrap_or(part);
    resolve_reference(part, schema)
}

/// The type of a key, in JSON's words.
fn type_of(schema: &Value, part: &Value) -> String {
    let part = resolved(schema, part);
    match &part["type"] {
        Value::String(name) => name.clone(),
        Value::Array(names) => names.iter().filter_map(Value::as_str).find(|name| *name != "null").unwrap_or("any").to_owned(),
        _ if part["oneOf"].is_array() || part["enum"].is_array() => "string".to_owned(),
        _ => "any".to_owned(),
    }
}

#[test]
fn listings_match_the_program() {
    for (file, make) in LISTINGS {
        let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../");
        let written = std::fs::read_to_string(format!("{root}{file}")).unwrap();
        assert!(written == make().unwrap(), "{file} is stale: run `cargo run -p basrelief-sim --example tables -- {file}`");
    }
}
