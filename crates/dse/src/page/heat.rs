//! An objective over two axes at once.

use super::data::{SweepView, colour};
use super::labels::{compact, rounded, shortened};
use super::scale::WHOLE;
use crate::effects::{ValueEffect, effects, level};
use crate::levels::{ColumnLevels, logarithmic, range};
use crate::rules::ObjectiveDirection;
use basrelief_report::html::markup::{Html, details, el, el_text};
use basrelief_report::html::svg::{label, px, svg_sized};

/// Maximum number of maps.
const MOST_MAPS: usize = 24;
const CELL: (f64, f64) = (74.0, 30.0);
/// Maximum width of the labels of the y axis.
const LEFT: f64 = 140.0;
const TOP: f64 = 40.0;

/// Two axes and an objective.
struct HeatMap {
    objective: (usize, ObjectiveDirection),
    upright: usize,
    across: usize,
}

/// Returns for each objective a map of the two axes with the largest effect; others open on demand.
pub(super) fn heat(sweep: &SweepView<'_>) -> Html {
    let (first, others) = maps(sweep);
    let total = first.len() + others.len();
    let draw = |map: &HeatMap| figure(sweep, map);
    let cards = el("div", &[("class", "maps")], first.iter().map(draw));
    let kept = others.len().min(MOST_MAPS.saturating_sub(first.len()));
    let more = el("div", &[("class", "maps")], others[..kept].iter().map(draw));
    if total == 0 {
        return Html::default();
    }
    let left = first.len() + kept;
    let left = if left < total { format!(" {left} of {total} maps are drawn, largest effect first.") } else { String::new() };
    let about =
        format!("Mean of an objective over all points with these two values. Cells without completed points are empty.{left}");
    let more = if kept > 0 { details(&format!("{kept} other pairs of axes"), more) } else { Html::default() };
    [el_text("p", "quiet", about), cards, more].into_iter().collect()
}

/// The first of each objective, then all others, by the order of their axes in the tornado.
fn maps(sweep: &SweepView<'_>) -> (Vec<HeatMap>, Vec<HeatMap>) {
    let effects = effects(sweep.table);
    let (mut first, mut others) = (vec![], vec![]);
    // An objective with one value needs no map.
    for objective in sweep.table.objectives().filter(|(at, _)| sweep.drawn_index(*at).is_some()) {
        let of = effects.iter().filter(|effect| effect.objective == objective.0 && effect.levels.len() > 1);
        let axes: Vec<usize> = of.map(|effect| effect.axis).collect();
        let pairs = (1..axes.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
        let mut maps = pairs.map(|(a, b)| HeatMap { objective, upright: axes[a], across: axes[b] });
        first.extend(maps.next());
        others.extend(maps);
    }
    (first, others)
}

fn figure(sweep: &SweepView<'_>, map: &HeatMap) -> Html {
    let [upright, across] = [map.upright, map.across].map(|axis| ColumnLevels::of(sweep.table, axis));
    let cells = cells(sweep, map, &upright, &across);
    let (low, high) = range(cells.iter().map(|(_, _, level)| level.mean)).unwrap_or_default();
    let unit = sweep.table.columns[map.objective.0].unit.as_str();
    let colours = ValueColours { low, high, unit, logarithmic: logarithmic((low, high)) };
    let names = [map.upright, map.across].map(|axis| sweep.table.columns[axis].name.as_str());
    let left = left(&upright);
    let shapes = cells
        .iter()
        .map(|(row, column, level)| cell([left + CELL.0 * *column as f64, TOP + CELL.1 * *row as f64], level, &colours));
    let sides = axis_labels(&upright, &across, names);
    let size = size(&upright, &across, names);
    let how = if colours.logarithmic { ", logarithmic colours" } else { "" };
    let title = format!("Mean of {}{how}", sweep.header(map.objective.0));
    let says = format!("{title} by {} and {}, from {} to {}", names[0], names[1], rounded(low, unit), rounded(high, unit));
    let drawing = svg_sized("map", size, 1.0, &says, shapes.chain(sides).collect());
    el("figure", &[], [el_text("figcaption", "", title), el("div", &[("class", "wide"), ("tabindex", "0")], [drawing])])
}

/// Room for the values of an upright axis.
fn left(levels: &ColumnLevels) -> f64 {
    let longest = levels.labels.iter().map(|label| label.chars().count()).max().unwrap_or(0);
    (longest as f64 * 6.8 + 12.0).min(LEFT)
}

/// Size of a map with its labels.
fn size(upright: &ColumnLevels, across: &ColumnLevels, names: [&str; 2]) -> (f64, f64) {
    let cells = left(upright) + CELL.0 * across.labels.len() as f64 + 4.0;
    let title = 6.8 * (names[0].chars().count() + names[1].chars().count() + 7) as f64;
    (cells.max(title), TOP + CELL.1 * upright.labels.len() as f64 + 4.0)
}

/// Colour and label of a value.
struct ValueColours<'a> {
    low: f64,
    high: f64,
    unit: &'a str,
    logarithmic: bool,
}

impl ValueColours<'_> {
    fn of(&self, x: f64) -> u32 {
        let along = |x: f64| if self.logarithmic { libm::log10(x) } else { x };
        let (low, high) = (along(self.low) / 2.0, along(self.high) / 2.0);
        let share = if high > low { (along(x) / 2.0 - low) / (high - low) } else { 0.0 };
        colour((share * f64::from(WHOLE)) as u32)
    }

    /// All of a map in the same way, as it fits into its cells.
    fn label(&self, x: f64) -> String {
        if self.low.abs().max(self.high.abs()) < 1e7 { rounded(x, self.unit) } else { compact(x) }
    }
}

/// Row, column and points of each cell that has any.
fn cells(
    sweep: &SweepView<'_>,
    map: &HeatMap,
    upright: &ColumnLevels,
    across: &ColumnLevels,
) -> Vec<(usize, usize, ValueEffect)> {
    let mut rows = vec![vec![]; upright.labels.len() * across.labels.len()];
    for (row, (a, b)) in upright.of_row.iter().zip(&across.of_row).enumerate() {
        if let Some((a, b)) = a.zip(*b) {
            rows[a * across.labels.len() + b].push(row);
        }
    }
    let width = across.labels.len();
    let (at, goal) = map.objective;
    let of = |(n, rows): (usize, &Vec<usize>)| Some((n / width, n % width, level(sweep.table, at, goal, "", rows)?));
    rows.iter().enumerate().filter_map(of).collect()
}

fn cell([x, y]: [f64; 2], level: &ValueEffect, colours: &ValueColours<'_>) -> Html {
    let colour = colours.of(level.mean);
    let points = if level.points == 1 { "1 point".into() } else { format!("{} points", level.points) };
    let title = format!("mean {}, best {}, {points}", rounded(level.mean, colours.unit), rounded(level.best, colours.unit));
    let shape = [
        ("class", format!("level-{colour}")),
        ("x", px(x)),
        ("y", px(y)),
        ("width", px(CELL.0 - 1.0)),
        ("height", px(CELL.1 - 1.0)),
    ];
    let shape: Vec<(&str, &str)> = shape.iter().map(|(name, value)| (*name, value.as_str())).collect();
    let written = label("middle", x + CELL.0 / 2.0, y + CELL.1 / 2.0 + 4.0, &colours.label(level.mean));
    el("g", &[("class", &format!("on-{colour}"))], [el_text("title", "", title), el("rect", &shape, []), written])
}

/// Names and values of both axes.
fn axis_labels<'a>(
    upright: &'a ColumnLevels,
    across: &'a ColumnLevels,
    [of_rows, of_columns]: [&'a str; 2],
) -> impl Iterator<Item = Html> + 'a {
    let left = left(upright);
    let row = move |(at, name): (usize, &String)| {
        label("end", left - 6.0, TOP + CELL.1 * (at as f64 + 0.5) + 4.0, &shortened(name, left - 8.0))
    };
    let column = move |(at, name): (usize, &String)| {
        label("middle", left + CELL.0 * (at as f64 + 0.5), TOP - 6.0, &shortened(name, CELL.0))
    };
    let names = label("start", 2.0, 14.0, &format!("{of_rows} ↓   {of_columns} →"));
    let (rows, columns) = (upright.labels.iter().enumerate().map(row), across.labels.iter().enumerate().map(column));
    rows.chain(columns).chain([names])
}
