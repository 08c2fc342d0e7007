//! A sweep as a Vega-Lite specification: to be opened in the Vega editor, in a notebook, or with `vl-convert`.

use crate::front::front_by;
use crate::table::{Column, Goal, Role, State, Table};
use crate::write::value;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

/// What the specification is written for.
pub const SCHEMA: &str = "https://vega.github.io/schema/vega-lite/v6.json";

/// A scatter of the first two objectives, the third by colour, with the front as a line and all axes in the tooltip. With fewer
/// objectives than two the first columns that are left stand in.
///
/// The data is within: of each point that has run its axes, objectives and constrained figures under the names of their
/// columns, `id`, `front` (whether no other point beats it), `line` (whether none does by the two that are shown) and `feasible`
/// (whether it keeps the constraints).
pub fn vega(table: &Table) -> Value {
    let told: Vec<usize> = (0..table.columns.len()).filter(|&at| is_told(table, at)).collect();
    let objectives = || table.objectives().map(|(at, _)| at);
    let mut places: Vec<usize> = objectives().collect();
    places.extend(told.iter().copied().filter(|&at| objectives().all(|objective| objective != at)));
    let shown: Vec<&Column> = places.iter().map(|&at| &table.columns[at]).collect();
    let tooltip: Vec<Value> =
        shown.iter().map(|column| json!({ "field": field(&column.name), "title": column.header() })).collect();
    let (across, upright) = (shown.first().map(|column| channel(column)), shown.get(1).map(|column| channel(column)));
    let third = objectives().nth(2).map(|at| &table.columns[at]);
    let colour = third.map_or(json!({ "field": "front", "type": "nominal", "title": "on the front" }), channel);
    json!({
        "$schema": SCHEMA,
        "title": table.title,
        "width": 640,
        "height": 420,
        "data": { "name": "points", "values": points(table, &told) },
        "encoding": encoding(across, upright),
        "layer": [
            {
                "transform": [{ "filter": "datum.line" }],
                "mark": { "type": "line", "interpolate": stair(table), "color": "#b8432c" },
            },
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

/// Whether a column says which point it is, or how good.
fn is_told(table: &Table, at: usize) -> bool {
    let column = &table.columns[at];
    column.role != Role::Figure || table.constraints.iter().any(|rule| rule.column == column.name)
}

fn encoding(across: Option<Value>, upright: Option<Value>) -> Value {
    let channels = [("x", across), ("y", upright)].into_iter().filter_map(|(name, channel)| Some((name.to_owned(), channel?)));
    Value::Object(channels.collect())
}

fn channel(column: &Column) -> Value {
    let mut channel = json!({ "field": field(&column.name), "title": column.header() });
    match column.role {
        // A measure may be anything; a parameter may be a word.
        Role::Axis => channel["type"] = "ordinal".into(),
        Role::Objective(_) | Role::Figure => {
            channel["type"] = "quantitative".into();
            channel["scale"] = json!({ "zero": false });
        }
    }
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

/// From point to point of the front, through what a point of it beats.
fn stair(table: &Table) -> &'static str {
    match table.objectives().next() {
        Some((_, Goal::Max)) => "step-before",
        _ => "step-after",
    }
}

fn points(table: &Table, told: &[usize]) -> Vec<Value> {
    let front: BTreeSet<usize> = crate::front(table).into_iter().collect();
    let shown: Vec<(usize, Goal)> = table.objectives().take(2).collect();
    // Fewer than two make no line.
    let line: BTreeSet<usize> = if shown.len() == 2 { front_by(table, &shown).into_iter().collect() } else { BTreeSet::new() };
    let run = table.rows.iter().enumerate().filter(|(_, row)| row.state == State::Ok);
    let point = |(number, row): (usize, &crate::Row)| {
        let own: [(&str, Value); 4] = [
            ("id", row.id.as_str().into()),
            ("front", front.contains(&number).into()),
            ("line", line.contains(&number).into()),
            ("feasible", table.feasible(row).into()),
        ];
        let cells = told.iter().filter_map(|&at| Some((table.columns[at].name.clone(), value(row.cells.get(at)?))));
        // The columns of the table come first: the point's own words are not to be replaced by them.
        let all: Map<String, Value> = cells.chain(own.map(|(name, value)| (name.to_owned(), value))).collect();
        Value::Object(all)
    };
    run.map(point).collect()
}
