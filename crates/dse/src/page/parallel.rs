//! A line per point, across an upright axis per column.

use super::data::{SweepView, thinned};
use super::labels::shortened;
use super::scale::WHOLE;
use basrelief_report::html::markup::{Html, el, el_text};
use basrelief_report::html::svg::{label, px, svg_sized};
use basrelief_report::number::thousands;
use serde_json::{Value, json};

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
        Self { columns, apart }
    }

    /// Returns the x coordinate of an axis.
    fn x(&self, number: usize) -> f64 {
        SIDE + number as f64 * self.apart
    }

    /// Returns the line of a row, with a gap at an unknown value.
    fn path(&self, sweep: &SweepView<'_>, row: usize) -> String {
        let mut path = String::new();
        let mut pen = 'M';
        for (number, &place) in self.columns.iter().enumerate() {
            let at = sweep.shown[place].scale.at[row];
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
         others."
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

/// Returns the positions of the axes for the script: number of the column and x coordinate.
pub(super) fn axis_positions(sweep: &SweepView<'_>) -> Value {
    let threads = ParallelCoordinates::of(sweep);
    let axes: Vec<(usize, f64)> = threads.columns.iter().enumerate().map(|(number, &place)| (place, threads.x(number))).collect();
    json!({ "axes": axes, "top": TOP, "height": HEIGHT })
}
