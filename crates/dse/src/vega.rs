//! A sweep as a Vega-Lite specification: to be opened in the Vega editor, in a notebook, or with `vl-convert`.

use crate::front::{front_by, input_column};
use crate::levels::{logarithmic, range};
use crate::rules::ObjectiveDirection;
use crate::table::{Column, ColumnRole, PointState, Table};
use crate::write::value;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

/// Version of the Vega-Lite schema.
pub const SCHEMA: &str = "https://vega.github.io/schema/vega-lite/v6.json";

/// Returns a scatter chart of the first two objectives, the third by colour, with the front as a line and all axes in the tooltip. With fewer
/// than two objectives, the next columns replace them.
///
/// The chart contains its data. Each point that has run has its axes, objectives and constrained figures under the names of their
/// columns, `id`, `front` (true if no other point dominates it), `line` (true if none does in the two shown objectives) and `feasible`
/// (true if it meets the constraints).
pub fn vega(table: &Table) -> Value {
    let told: Vec<usize> = (0..table.columns.len()).filter(|&at| is_told(table, at)).collect();
    let objectives = || table.objectives().map(|(at, _)| at);
    let mut places: Vec<usize> = objectives().collect();
    places.extend(told.iter().copied().filter(|&at| objectives().all(|objective| objective != at)));
    let tooltip: Vec<Value> = places.iter().map(|&at| named(&table.columns[at])).collect();
    let [across, upright] = [0, 1].map(|number| places.get(number).map(|&at| channel(table, at)));
    let mut colour = json!({ "field": "front", "type": "nominal", "title": "on the front" });
    if let Some(third) = objectives().nth(2) {
        colour = channel(table, third);
        // The other way round, its first colours would be lost on white.
        colour["scale"]["scheme"] = "viridis".into();
        colour["scale"]["reverse"] = true.into();
    }
    let mut line = json!({
        "transform": [{ "filter": "datum.line" }],
        "mark": { "type": "line", "interpolate": stair(table), "color": "#b8432c" },
    });
    if let Some(input) = input_column(table) {
        // One line for each input.
        line["encoding"] = json!({ "detail": { "field": field(&table.columns[input].name) } });
    }
    json!({
        "$schema": SCHEMA,
        "title": table.title,
        "width": 640,
        "height": 420,
        "data": { "name": "points", "values": points(table, &told) },
        "encoding": encoding(across, upright),
        "layer": [
            line,
            {
                "mark": { "type": "point", "filled": true },
                "encoding": {
                    "color": colour,
                    "opacity": { "condition": { "test": "datum.front", "value": 1 }, "value": 0.4 },
                    "size": { "condition": { "test": "datum.front", "value": 90 }, "value": 35 },
                    "tooltip": tooltip,
                },
            },
        ],
    })
}

/// Returns true if a column is an axis, an objective or a constrained figure.
fn is_told(table: &Table, at: usize) -> bool {
    let column = &table.columns[at];
    column.role != ColumnRole::Figure || table.constraints.iter().any(|rule| rule.column == column.name)
}

fn encoding(across: Option<Value>, upright: Option<Value>) -> Value {
    let channels = [("x", across), ("y", upright)].into_iter().filter_map(|(name, channel)| Some((name.to_owned(), channel?)));
    Value::Object(channels.collect())
}

/// A column under its name and unit.
fn named(column: &Column) -> Value {
    json!({ "field": field(&column.name), "title": column.header() })
}

/// A column by position or colour.
fn channel(table: &Table, at: usize) -> Value {
    let mut channel = named(&table.columns[at]);
    if table.columns[at].role == ColumnRole::Axis {
        // A parameter may be a word.
        channel["type"] = "ordinal".into();
        return channel;
    }
    let numbers = table.rows.iter().filter_map(|row| row.cells.get(at)?.number());
    let logarithmic = range(numbers).is_some_and(logarithmic);
    channel["type"] = "quantitative".into();
    channel["scale"] = if logarithmic { json!({ "type": "log" }) } else { json!({ "zero": false }) };
    channel
}

/// A name in which dots and brackets do not lead into an object.
fn field(name: &str) -> String {
    let mut out = String::new();
    for c in name.chars() {
        if matches!(c, '.' | '[' | ']' | '\\' | '\'' | '"') {
            out.push('\\');
        }
        out.push(c);
    }
    out
}

/// Path of the Pareto front, in steps.
fn stair(table: &Table) -> &'static str {
    match table.objectives().next() {
        Some((_, ObjectiveDirection::Max)) => "step-before",
        _ => "step-after",
    }
}

fn points(table: &Table, told: &[usize]) -> Vec<Value> {
    let front: BTreeSet<usize> = crate::front(table).into_iter().collect();
    let shown: Vec<(usize, ObjectiveDirection)> = table.objectives().take(2).collect();
    // Fewer than two make no line.
    let line: BTreeSet<usize> = if shown.len() == 2 { front_by(table, &shown).into_iter().collect() } else { BTreeSet::new() };
    let run = table.rows.iter().enumerate().filter(|(_, row)| row.state == PointState::Ok);
    let point = |(number, row): (usize, &crate::Row)| {
        let own: [(&str, Value); 4] = [
            ("id", row.id.as_str().into()),
            ("front", front.contains(&number).into()),
            ("line", line.contains(&number).into()),
            ("feasible", table.feasible(row).into()),
        ];
        let cells = told.iter().filter_map(|&at| Some((table.columns[at].name.clone(), value(row.cells.get(at)?))));
        // The point's own keys come last, so that columns of the table cannot replace them.
        let all: Map<String, Value> = cells.chain(own.map(|(name, value)| (name.to_owned(), value))).collect();
        Value::Object(all)
    };
    run.map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples;

    /// The schema has 30,000 lines; these are the parts of it that a scatter needs. That all of it holds was seen with the schema
    /// of vega-lite 6.4.3.
    #[test]
    fn a_scatter_has_points_a_line_and_what_the_pointer_tells() {
        let spec = vega(&samples::device(30));
        assert_eq!(spec["$schema"], SCHEMA);
        let encoding = &spec["encoding"];
        assert_eq!((&encoding["x"]["field"], &encoding["x"]["scale"]["type"]), (&json!("cycles\\.total"), &json!("log")));
        assert_eq!(
            (&encoding["y"]["title"], &encoding["y"]["scale"]),
            (&json!("quality.psnr_db [dB]"), &json!({ "zero": false }))
        );
        let [line, points] = spec["layer"].as_array().unwrap().as_slice() else { panic!("{}", spec["layer"]) };
        assert_eq!(line["mark"]["interpolate"], "step-after");
        assert_eq!(points["encoding"]["color"]["field"], "memories\\.bytes");
        assert_eq!(points["encoding"]["tooltip"].as_array().unwrap().len(), 7);
    }

    #[test]
    fn the_data_is_that_of_the_points_that_have_run() {
        let table = samples::device(30);
        let spec = vega(&table);
        let values = spec["data"]["values"].as_array().unwrap();
        let run: Vec<&crate::Row> = table.rows.iter().filter(|row| row.state == PointState::Ok).collect();
        assert_eq!((values.len(), run.len()), (29, 29));
        assert_eq!(values[0]["cycles.total"], value(&run[0].cells[0]));
        let count = |name: &str| values.iter().filter(|point| point[name] == true).count();
        let shown: Vec<(usize, ObjectiveDirection)> = table.objectives().take(2).collect();
        assert_eq!((count("front"), count("line")), (crate::front(&table).len(), front_by(&table, &shown).len()));
    }

    #[test]
    fn names_do_not_lead_into_objects_and_nothing_is_needed() {
        assert_eq!(field("a.b[0]'\""), "a\\.b\\[0\\]\\'\\\"");
        let empty = vega(&Table::default());
        assert_eq!((&empty["encoding"], &empty["data"]["values"]), (&json!({}), &json!([])));
    }
}
