//! A line per point, across an upright axis per column.

use super::data::{Sweep, thinned};
use super::scale::{Scale, WHOLE};
use super::scatter::cut;
use basrelief_report::html::markup::{Html, el, el_text};
use basrelief_report::html::svg::{label, px, svg_sized};
use basrelief_report::text::number::thousands;
use serde_json::{Value, json};

/// Most lines.
const MOST_LINES: usize = 400;
/// Most axes.
const MOST_AXES: usize = 14;
/// Distance of two axes, and room beside the first and the last.
const APART: f64 = 132.0;
const SIDE: f64 = 70.0;
const TOP: f64 = 48.0;
const HEIGHT: f64 = 300.0;

/// Axes of the plan first, then objectives: from what was chosen to what came of it. Places among the columns shown.
fn columns(sweep: &Sweep<'_>) -> Vec<usize> {
    let objectives = sweep.table.objectives().map(|(at, _)| at);
    let all = sweep.table.axes().chain(objectives).chain(sweep.told());
    let mut places: Vec<usize> = vec![];
    for place in all.filter_map(|at| sweep.place(at)) {
        if !places.contains(&place) {
            places.push(place);
        }
    }
    places.truncate(MOST_AXES);
    places
}

fn x(number: usize) -> f64 {
    SIDE + number as f64 * APART
}

fn y(at: u32) -> f64 {
    TOP + (1.0 - f64::from(at) / f64::from(WHOLE)) * HEIGHT
}

pub(super) fn parallel(sweep: &Sweep<'_>) -> Html {
    let columns = columns(sweep);
    if columns.len() < 3 || sweep.drawn.is_empty() {
        return Html::default();
    }
    let (best, others): (Vec<usize>, Vec<usize>) = sweep.drawn.iter().partition(|row| sweep.is_best(**row));
    let best = thinned(&best, MOST_LINES / 2);
    let others = thinned(&others, MOST_LINES - best.len());
    let line = |class: &'static str| {
        let columns = &columns;
        move |row: usize| el("path", &[("class", class), ("d", &path(sweep, columns, row))], [])
    };
    let about = format!(
        "A line per point, from what was chosen to what came of it: {} on the front, drawn strong, and {} others of {}.",
        thousands(best.len() as u64),
        thousands(others.len() as u64),
        thousands((sweep.run() - sweep.front.len()) as u64)
    );
    let lines = others.iter().copied().map(line("thread")).chain(best.iter().copied().map(line("thread best")));
    let cursor = el("path", &[("id", "thread"), ("class", "off")], []);
    let axes = columns.iter().enumerate().map(|(number, &place)| axis(sweep, number, place));
    let size = (x(columns.len() - 1) + SIDE, TOP + HEIGHT + 16.0);
    let drawing = svg_sized("threads", size, 1.0, &about, lines.chain([cursor]).chain(axes).collect());
    [el_text("p", "quiet", &about), el("div", &[("class", "wide"), ("tabindex", "0")], [drawing])].into_iter().collect()
}

/// A gap where nothing is known.
fn path(sweep: &Sweep<'_>, columns: &[usize], row: usize) -> String {
    let mut path = String::new();
    let mut pen = 'M';
    for (number, &place) in columns.iter().enumerate() {
        match sweep.shown[place].scale.at[row] {
            Some(at) => path += &format!("{pen}{} {}", px(x(number)), px(y(at))),
            None => pen = 'M',
        }
        if sweep.shown[place].scale.at[row].is_some() {
            pen = 'L';
        }
    }
    path
}

fn axis(sweep: &Sweep<'_>, number: usize, place: usize) -> Html {
    let shown = &sweep.shown[place];
    let column = &sweep.table.columns[shown.column];
    let line = format!("M{} {} V{}", px(x(number)), px(TOP), px(TOP + HEIGHT));
    let unit = if column.unit.is_empty() { String::new() } else { format!("[{}]", column.unit) };
    let titles = [
        label("middle", x(number), 14.0, &end(&column.name, APART)),
        label("middle", x(number), 28.0, &cut(&unit, APART)),
        el("path", &[("class", "axis"), ("d", &line)], []),
    ];
    el("g", &[], titles.into_iter().chain(marks(&shown.scale, number)))
}

/// The last part of a name says most.
fn end(name: &str, room: f64) -> String {
    let most = (room / 6.8) as usize;
    let count = name.chars().count();
    if count <= most { name.into() } else { std::iter::once('…').chain(name.chars().skip(count + 1 - most)).collect() }
}

fn marks(scale: &Scale, number: usize) -> impl Iterator<Item = Html> {
    scale.ticks.iter().map(move |(at, name)| label("end", x(number) - 5.0, y(*at) + 4.0, &cut(name, APART / 2.0)))
}

/// Where the axes stand, for the script: place of the column and distance from the left.
pub(super) fn places(sweep: &Sweep<'_>) -> Value {
    let places: Vec<(usize, f64)> = columns(sweep).into_iter().enumerate().map(|(number, place)| (place, x(number))).collect();
    json!({ "axes": places, "top": TOP, "height": HEIGHT })
}
