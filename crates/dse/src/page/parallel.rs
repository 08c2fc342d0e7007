//! A line per point, across an upright axis per column.

use super::data::{SweepView, thinned};
use super::labels::shortened;
use super::scale::WHOLE;
use basrelief_report::html::markup::{Html, el, el_text};
use basrelief_report::html::svg::{label, px, svg_sized};
use basrelief_report::number::thousands;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Maximum number of lines. More lines would hide each other.
const MOST_LINES: usize = 300;
const MOST_BEST: usize = 60;
/// Maximum number of axes.
const MOST_AXES: usize = 14;
/// Minimum distance of two axes.
const APART: f64 = 132.0;
const WIDTH: f64 = 1130.0;
const SIDE: f64 = 70.0;
const TOP: f64 = 48.0;
const HEIGHT: f64 = 300.0;

/// The axes of the drawing.
struct ParallelCoordinates {
    /// Numbers of the columns: axes of the plan first, then objectives.
    columns: Vec<usize>,
    /// Distance of two.
    apart: f64,
    /// Positions of the drawn rows on each axis with few values, where lines lie beside each other; `None` for other axes.
    spread: Vec<Option<BTreeMap<usize, u32>>>,
}

/// Part of the distance of two values over which lines through one value are spread.
const SPREAD: f64 = 0.7;

/// Returns positions around each value of an axis of few values: one for each drawn row, in the order of the first objective. So lines
/// do not hide each other.
fn spread(sweep: &SweepView<'_>, place: usize) -> Option<BTreeMap<usize, u32>> {
    let scale = &sweep.shown[place].scale;
    let band = SPREAD * f64::from(WHOLE) / scale.levels? as f64;
    let first = sweep.table.objectives().find_map(|(at, _)| sweep.drawn_index(at));
    let goodness = |row: usize| first.and_then(|first| sweep.shown[first].scale.at[row]);
    let mut rows: Vec<(u32, usize)> = sweep.drawn.iter().filter_map(|&row| Some((scale.at[row]?, row))).collect();
    rows.sort_by_key(|&(at, row)| (at, goodness(row), row));
    let places = rows.chunk_by(|a, b| a.0 == b.0).flat_map(|rows| {
        let share = move |n: usize| (n as f64 + 0.5) / rows.len() as f64 - 0.5;
        rows.iter().enumerate().map(move |(n, &(at, row))| (row, libm::round(f64::from(at) + band * share(n)) as u32))
    });
    Some(places.collect())
}

impl ParallelCoordinates {
    fn of(sweep: &SweepView<'_>) -> Self {
        let objectives = sweep.table.objectives().map(|(at, _)| at);
        let all = sweep.table.axes().chain(objectives).chain(sweep.summary_columns());
        let mut columns: Vec<usize> = vec![];
        for place in all.filter_map(|at| sweep.drawn_index(at)) {
            if !columns.contains(&place) {
                columns.push(place);
            }
        }
        columns.truncate(MOST_AXES);
        let apart = (WIDTH / (columns.len().max(2) - 1) as f64).max(APART);
        let spread = columns.iter().map(|&place| spread(sweep, place)).collect();
        Self { columns, apart, spread }
    }

    /// Returns the x coordinate of an axis.
    fn x(&self, number: usize) -> f64 {
        SIDE + number as f64 * self.apart
    }

    /// Returns the position of a row on an axis; `None` without a value.
    fn at(&self, sweep: &SweepView<'_>, number: usize, row: usize) -> Option<u32> {
        match &self.spread[number] {
            Some(spread) => spread.get(&row).copied(),
            None => sweep.shown[self.columns[number]].scale.at[row],
        }
    }

    /// Returns the line of a row, with a gap at an unknown value.
    fn path(&self, sweep: &SweepView<'_>, row: usize) -> String {
        let mut path = String::new();
        let mut pen = 'M';
        for number in 0..self.columns.len() {
            let at = self.at(sweep, number, row);
            path.extend(at.map(|at| format!("{pen}{} {}", px(self.x(number)), px(y(at)))));
            pen = if at.is_some() { 'L' } else { 'M' };
        }
        path
    }

    fn axis(&self, sweep: &SweepView<'_>, number: usize) -> Html {
        let shown = &sweep.shown[self.columns[number]];
        let column = &sweep.table.columns[shown.column];
        let x = self.x(number);
        let line = format!("M{} {} V{}", px(x), px(TOP), px(TOP + HEIGHT));
        let unit = if column.unit.is_empty() { String::new() } else { format!("[{}]", column.unit) };
        let titles = [
            label("middle", x, 14.0, &end_of_name(&column.name, self.apart)),
            label("middle", x, 28.0, &shortened(&unit, self.apart)),
            el("path", &[("class", "axis"), ("d", &line)], []),
        ];
        let mark = |(at, name): &(u32, String)| label("end", x - 5.0, y(*at) + 4.0, &shortened(name, self.apart / 2.0));
        el("g", &[], titles.into_iter().chain(shown.scale.ticks.iter().map(mark)))
    }
}

fn y(at: u32) -> f64 {
    TOP + (1.0 - f64::from(at) / f64::from(WHOLE)) * HEIGHT
}

/// Returns the end of a name, because its last part is the most specific.
fn end_of_name(name: &str, room: f64) -> String {
    let most = (room / 6.8) as usize;
    let count = name.chars().count();
    if count <= most { name.into() } else { std::iter::once('…').chain(name.chars().skip(count + 1 - most)).collect() }
}

/// The drawing; nothing of fewer than three columns, which the scatter shows.
pub(super) fn parallel(sweep: &SweepView<'_>) -> Html {
    let threads = ParallelCoordinates::of(sweep);
    if threads.columns.len() < 3 || sweep.drawn.is_empty() {
        return Html::default();
    }
    let (best, others): (Vec<usize>, Vec<usize>) = sweep.drawn.iter().partition(|row| sweep.is_best(**row));
    let best = thinned(&best, MOST_BEST);
    let others = thinned(&others, MOST_LINES - best.len());
    let all = [best.len(), sweep.front.len(), others.len(), sweep.run() - sweep.front.len()].map(|count| thousands(count as u64));
    let [of_front, front, of_others, not] = all;
    let about = format!(
        "One line per point, from parameters to results: {of_front} of {front} Pareto-optimal points (bold) and {of_others} of {not} \
         others. On an axis with few values, lines through the same value lie beside each other."
    );
    let line = |class: &'static str| {
        let threads = &threads;
        move |&row: &usize| el("path", &[("class", class), ("d", &threads.path(sweep, row))], [])
    };
    let lines = others.iter().map(line("thread")).chain(best.iter().map(line("thread best")));
    let cursor = el("path", &[("id", "thread"), ("class", "off")], []);
    let axes = (0..threads.columns.len()).map(|number| threads.axis(sweep, number));
    let size = (threads.x(threads.columns.len() - 1) + SIDE, TOP + HEIGHT + 16.0);
    let drawing = svg_sized("threads", size, 1.0, &about, lines.chain([cursor]).chain(axes).collect());
    [el_text("p", "quiet", &about), el("div", &[("class", "wide"), ("tabindex", "0")], [drawing])].into_iter().collect()
}

/// Returns the axes for the script: number of the column, x coordinate, and positions of the drawn rows if they are spread.
pub(super) fn axis_positions(sweep: &SweepView<'_>) -> Value {
    let threads = ParallelCoordinates::of(sweep);
    let of_rows = |spread: &BTreeMap<usize, u32>| sweep.drawn.iter().map(|row| spread.get(row).copied()).collect::<Vec<_>>();
    let axis = |(number, place): (usize, &usize)| json!([place, threads.x(number), threads.spread[number].as_ref().map(of_rows)]);
    let axes: Vec<Value> = threads.columns.iter().enumerate().map(axis).collect();
    json!({ "axes": axes, "top": TOP, "height": HEIGHT })
}
