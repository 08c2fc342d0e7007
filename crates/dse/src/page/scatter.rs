//! Points by any two or three figures.

use super::data::{COLOURS, SweepView, colour};
use super::labels::{self, shortened};
use super::scale::{ColumnScale, WHOLE};
use crate::front::{front_by, input_column};
use crate::rules::ObjectiveDirection;
use crate::table::ColumnRole;
use basrelief_report::html::markup::{Html, el, el_text, text};
use basrelief_report::html::svg::{label, px, svg};
use basrelief_report::number::thousands;
use serde_json::{Value, json};

const SIZE: (f64, f64) = (860.0, 520.0);
/// Left, top, width, height of the plot area.
const BOX: [f64; 4] = [76.0, 26.0, 768.0, 440.0];

/// The drawing, the selection of its figures, and the selected point.
pub(super) fn scatter(sweep: &SweepView<'_>) -> Html {
    let Some((across, upright)) = first_pair(sweep) else { return Html::default() };
    let shapes = [axes(sweep, across, upright), lines(sweep, across, upright), points(sweep, across, upright)];
    let says = format!("Scatter chart of {} points. Arrow keys move between points.", sweep.drawn.len());
    let plot = svg("plot", SIZE, &says, "xMidYMid meet", shapes.into_iter().collect());
    let plot = el("div", &[("id", "plot"), ("tabindex", "0"), ("role", "group"), ("aria-label", &says)], [plot]);
    let point = el("aside", &[("id", "point"), ("aria-live", "polite"), ("hidden", "hidden")], []);
    let sides = el("div", &[("class", "beside")], [el("div", &[], [plot, legend(sweep)]), point]);
    [el_text("p", "quiet", about(sweep)), choices(sweep, across, upright), sides].into_iter().collect()
}

/// The two figures at first: the first two objectives, otherwise the first columns.
fn first_pair(sweep: &SweepView<'_>) -> Option<(usize, usize)> {
    let mut places = sweep.table.objectives().filter_map(|(at, _)| sweep.drawn_index(at)).chain(0..sweep.shown.len());
    let across = places.next()?;
    Some((across, places.find(|place| *place != across)?))
}

fn about(sweep: &SweepView<'_>) -> String {
    let (run, drawn) = (sweep.run(), sweep.drawn.len());
    let best = sweep.drawn.iter().filter(|row| sweep.is_best(**row)).count();
    let [of_front, of_others, front, others] =
        [best, drawn - best, sweep.front.len(), run - sweep.front.len()].map(|count| thousands(count as u64));
    let all = if drawn == run {
        format!("All {} completed points are drawn. ", thousands(run as u64))
    } else {
        format!(
            "Drawn: {of_front} of {front} Pareto-optimal points and {of_others} of {others} others, at equal distances in the plan. "
        )
    };
    let [line, beside] = match input_column(sweep.table) {
        None => ["The line is the Pareto front of the two figures", "it"],
        Some(_) => ["The lines are the Pareto fronts of the two figures, one for each input", "them"],
    };
    let rest = "Arrow keys move between points; click or Enter selects one.";
    format!(
        "{all}{line}, if both are objectives. Points that are Pareto-optimal for all objectives may lie beside {beside}. {rest}"
    )
}

/// Places of each pair of figures in the drawing: titles, marks, both directions; only those of two are seen.
fn axes(sweep: &SweepView<'_>, across: usize, upright: usize) -> Html {
    let [left, top, width, height] = BOX;
    let frame = format!("M{} {} V{} H{}", px(left), px(top), px(top + height), px(left + width));
    let each = sweep.shown.iter().enumerate().flat_map(|(place, shown)| {
        let title = axis_title(sweep, shown.column, &shown.scale);
        [("x", across, across_marks(&shown.scale, &title)), ("y", upright, upright_marks(&shown.scale, &title))]
            .map(|(name, seen, marks)| group(&format!("{name}-{place}"), place == seen, marks))
    });
    each.chain([el("path", &[("class", "axis"), ("d", &frame)], [])]).collect()
}

/// Shapes that are seen or not.
fn group(id: &str, seen: bool, shapes: Html) -> Html {
    el("g", &[("id", id), ("class", if seen { "" } else { "off" })], [shapes])
}

fn axis_title(sweep: &SweepView<'_>, column: usize, scale: &ColumnScale) -> String {
    let goal = match sweep.table.columns[column].role {
        ColumnRole::Objective(ObjectiveDirection::Min) => " (lower is better)",
        ColumnRole::Objective(ObjectiveDirection::Max) => " (higher is better)",
        ColumnRole::Axis | ColumnRole::Figure => "",
    };
    format!("{}{goal}{}", sweep.header(column), if scale.logarithmic { ", logarithmic" } else { "" })
}

fn x(at: u32) -> f64 {
    BOX[0] + f64::from(at) / f64::from(WHOLE) * BOX[2]
}

fn y(at: u32) -> f64 {
    BOX[1] + (1.0 - f64::from(at) / f64::from(WHOLE)) * BOX[3]
}

fn across_marks(scale: &ColumnScale, title: &str) -> Html {
    let [left, top, width, height] = BOX;
    let room = width / scale.ticks.len().max(1) as f64;
    let marks = scale.ticks.iter().flat_map(|(at, name)| {
        let line = format!("M{} {} V{}", px(x(*at)), px(top), px(top + height));
        [el("path", &[("class", "mark"), ("d", &line)], []), label("middle", x(*at), top + height + 17.0, &shortened(name, room))]
    });
    marks.chain([label("end", left + width, top + height + 40.0, title)]).collect()
}

fn upright_marks(scale: &ColumnScale, title: &str) -> Html {
    let [left, _, width, _] = BOX;
    let marks = scale.ticks.iter().flat_map(|(at, name)| {
        let line = format!("M{} {} H{}", px(left), px(y(*at)), px(left + width));
        let number = label("end", left - 6.0, y(*at) + 4.0, &shortened(name, left - 8.0));
        // A narrow page shows the large numbers inside, where they have room.
        [el("path", &[("class", "mark"), ("d", &line)], []), el("g", &[("class", "inside")], [number])]
    });
    marks.chain([label("start", 4.0, 14.0, title)]).collect()
}

/// Fronts of each two objectives, as stairs.
fn lines(sweep: &SweepView<'_>, across: usize, upright: usize) -> Html {
    let objectives: Vec<(usize, usize, ObjectiveDirection)> =
        sweep.table.objectives().filter_map(|(at, goal)| Some((sweep.drawn_index(at)?, at, goal))).collect();
    let pairs = objectives.iter().flat_map(|a| objectives.iter().filter(move |b| a.0 != b.0).map(move |b| (a, b)));
    let line = |(a, b): (&(usize, usize, ObjectiveDirection), &(usize, usize, ObjectiveDirection))| {
        let seen = (a.0, b.0) == (across, upright);
        let path = stairs(sweep, (a.1, a.2), (b.1, b.2), [&sweep.shown[a.0].scale, &sweep.shown[b.0].scale]);
        let class = if seen { "line" } else { "line off" };
        el("path", &[("id", &format!("line-{}-{}", a.0, b.0)), ("class", class), ("d", &path)], [])
    };
    pairs.map(line).collect()
}

/// Path of the Pareto front of two objectives: a point of the front dominates all points beyond the line.
fn stairs(
    sweep: &SweepView<'_>,
    a: (usize, ObjectiveDirection),
    b: (usize, ObjectiveDirection),
    [across, upright]: [&ColumnScale; 2],
) -> String {
    let front = front_by(sweep.table, &[a, b]).into_iter();
    let mut steps: Vec<(usize, u32, u32)> =
        front.filter_map(|row| Some((sweep.inputs[row], across.at[row]?, upright.at[row]?))).collect();
    steps.sort_unstable();
    steps.dedup();
    let better_right = a.1 == ObjectiveDirection::Max;
    let mut path = String::new();
    for of_input in steps.chunk_by(|a, b| a.0 == b.0) {
        for (number, (_, at_x, at_y)) in of_input.iter().enumerate() {
            let (x, y) = (px(x(*at_x)), px(y(*at_y)));
            path += &match (number, better_right) {
                (0, _) => format!("M{x} {y}"),
                (_, false) => format!(" H{x} V{y}"),
                (_, true) => format!(" V{y} H{x}"),
            };
        }
    }
    path
}

fn points(sweep: &SweepView<'_>, across: usize, upright: usize) -> Html {
    let [horizontal, vertical] = [across, upright].map(|place| &sweep.shown[place].scale.at);
    let point = |&row: &usize| {
        let (at_x, at_y) = (horizontal[row], vertical[row]);
        let default = if sweep.is_default(row) { " default" } else { "" };
        let class = format!("{}{default}{}", class(sweep, row), if at_x.and(at_y).is_some() { "" } else { " off" });
        let (cx, cy) = (px(x(at_x.unwrap_or(0))), px(y(at_y.unwrap_or(0))));
        let radius = if sweep.is_best(row) { "5.5" } else { "3.5" };
        el("circle", &[("class", &class), ("cx", &cx), ("cy", &cy), ("r", radius)], [])
    };
    let cursor = el("circle", &[("id", "cursor"), ("class", "off"), ("r", "10")], []);
    el("g", &[("id", "points")], sweep.drawn.iter().map(point).chain([cursor]))
}

/// Class of a point.
fn class(sweep: &SweepView<'_>, row: usize) -> &'static str {
    match row {
        _ if sweep.is_best(row) => "point best",
        _ if sweep.table.feasible(&sweep.table.rows[row]) => "point",
        _ => "point broken",
    }
}

fn legend(sweep: &SweepView<'_>) -> Html {
    let item = |class: &str, radius: &str, meaning: &str| {
        let dot = el("circle", &[("class", class), ("cx", "7"), ("cy", "7"), ("r", radius)], []);
        let dot = el("svg", &[("class", "dot"), ("viewBox", "0 0 14 14"), ("aria-hidden", "true")], [dot]);
        el("li", &[], [dot, text(meaning)])
    };
    let broken = sweep.table.constraints.iter().map(|_| item("point broken", "3.5", "violates a constraint")).take(1);
    let has_default = sweep.drawn.iter().any(|row| sweep.is_default(*row));
    let default = has_default.then(|| item("point default", "5.5", "default: as in the plan without its axes"));
    let items = [item("point best", "5.5", "Pareto-optimal"), item("point", "3.5", "other")].into_iter();
    let selected = item("selected", "6", "selected: shown beside the chart");
    let items = items.chain(default).chain(broken).chain([selected]);
    let scales = sweep.shown.iter().enumerate().map(|(place, shown)| {
        let swatches = (0..COLOURS).map(|k| el_text("span", &format!("swatch level-{k}"), ""));
        let [low, high] = &shown.scale.ends;
        let ends = |end: &str| el_text("span", "quiet", end);
        let name = sweep.header(shown.column);
        let parts = [ends(&format!("{name}: {low}"))].into_iter().chain(swatches).chain([ends(high)]);
        el("p", &[("id", &format!("colours-{place}")), ("class", "colours"), ("hidden", "hidden")], parts)
    });
    el("div", &[], [el("ul", &[("class", "legend")], items), scales.collect()])
}

fn choices(sweep: &SweepView<'_>, across: usize, upright: usize) -> Html {
    let option = |value: &str, name: &str, chosen: bool| {
        let attributes = [("value", value), ("selected", "selected")];
        el("option", &attributes[..if chosen { 2 } else { 1 }], [text(name)])
    };
    let options = |chosen: Option<usize>| -> Html {
        let each = sweep.shown.iter().enumerate();
        each.map(|(place, shown)| option(&place.to_string(), &sweep.header(shown.column), chosen == Some(place))).collect()
    };
    let select = |id: &str, name: &str, options: Html| {
        el("label", &[], [text(format!("{name} ")), el("select", &[("id", id)], [options])])
    };
    // The third objective is the colour at first, because the axes show two of them.
    let third = sweep.table.objectives().filter_map(|(at, _)| sweep.drawn_index(at)).find(|at| ![across, upright].contains(at));
    let none = option("", "Pareto front", third.is_none());
    let selects = [
        select("across", "horizontal axis", options(Some(across))),
        select("upright", "vertical axis", options(Some(upright))),
        select("colour", "colour", [none, options(third)].into_iter().collect()),
    ];
    // Without the script nothing would happen.
    el("form", &[("id", "choose"), ("hidden", "hidden")], selects)
}

/// Data for the script: positions and colours of all points, and their texts.
pub(super) fn data(sweep: &SweepView<'_>) -> Html {
    let told = sweep.summary_columns();
    let columns: Vec<Value> = sweep.shown.iter().map(|shown| column(sweep, &shown.scale)).collect();
    let rows: Vec<Value> = sweep.drawn.iter().map(|&row| point(sweep, &told, row)).collect();
    let names: Vec<String> = told.iter().map(|&at| sweep.header(at)).collect();
    let parallel = super::parallel::axis_positions(sweep);
    let value = json!({ "box": BOX, "whole": WHOLE, "columns": columns, "names": names, "rows": rows, "parallel": parallel });
    Html::data("sweep", &value)
}

fn column(sweep: &SweepView<'_>, scale: &ColumnScale) -> Value {
    let at: Vec<Option<u32>> = sweep.drawn.iter().map(|&row| scale.at[row]).collect();
    let colours: String = at.iter().map(|at| at.and_then(|at| char::from_digit(colour(at), 10)).unwrap_or('-')).collect();
    json!({ "at": at, "colours": colours })
}

fn point(sweep: &SweepView<'_>, told: &[usize], row: usize) -> Value {
    let cells = &sweep.table.rows[row].cells;
    let values: Vec<String> = told
        .iter()
        .map(|&at| cells.get(at).map_or(String::new(), |cell| labels::cell(cell, &sweep.table.columns[at].unit)))
        .collect();
    let of = &sweep.table.rows[row];
    let [best, tie, default] = [sweep.is_best(row), sweep.is_tie(row), sweep.is_default(row)];
    json!({ "id": of.id, "picture": of.picture, "best": best, "tie": tie, "default": default, "values": values })
}
