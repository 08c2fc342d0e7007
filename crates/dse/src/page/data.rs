//! Rows and columns of the page, and their positions.

use super::scale::{ColumnScale, WHOLE};
use crate::table::{ColumnRole, PointState, Table};
use std::collections::{BTreeMap, BTreeSet};

/// Maximum number of drawn rows.
pub(super) const MOST_ROWS: usize = 2_000;
/// Maximum number of drawn rows of the front.
const MOST_FRONT: usize = 1_000;
/// Maximum number of marked defaults; a plan has one per input.
const MOST_DEFAULTS: usize = 100;
/// Maximum number of columns in the selection.
const MOST_COLUMNS: usize = 24;
/// Colours of a scale.
pub(super) const COLOURS: u32 = 7;

/// Contents of a page beside the table.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PageOptions {
    /// Names of figures that the page offers first. Unknown names are ignored.
    pub figures: Vec<String>,
    /// Hashes of the points whose parameters are as in the plan without its axes. They are marked.
    pub defaults: Vec<String>,
    /// Files beside the page that hold the whole table: path relative to the page, and description.
    pub files: Vec<(String, String)>,
}

/// A column that can be drawn.
pub(super) struct DrawnColumn {
    /// Number of the column in the table.
    pub(super) column: usize,
    pub(super) scale: ColumnScale,
}

/// A sweep, ready to be drawn.
pub(super) struct SweepView<'a> {
    pub(super) table: &'a Table,
    /// Rows on the front, in the order of the table.
    pub(super) front: Vec<usize>,
    /// Rows that are drawn: those on the front last, so that nothing hides them.
    pub(super) drawn: Vec<usize>,
    /// Columns that can be drawn: objectives, axes, constrained figures, requested columns, then others.
    pub(super) shown: Vec<DrawnColumn>,
    /// Number of each row's input.
    pub(super) inputs: Vec<usize>,
    on_front: BTreeSet<usize>,
    /// Ties of points on the front, each with its point.
    ties: BTreeMap<usize, usize>,
    defaults: BTreeSet<usize>,
}

impl<'a> SweepView<'a> {
    pub(super) fn new(table: &'a Table, options: &'a PageOptions) -> Self {
        let points = crate::front::front_points(table);
        let front: Vec<usize> = points.iter().map(|point| point.row).collect();
        let ties = points.iter().flat_map(|point| point.ties.iter().map(|tie| (*tie, point.row))).collect();
        let on_front: BTreeSet<usize> = front.iter().copied().collect();
        let best = thinned(&front, MOST_FRONT);
        let is_default = |row: &usize| options.defaults.contains(&table.rows[*row].id);
        let defaults: BTreeSet<usize> = (0..table.rows.len()).filter(is_default).take(MOST_DEFAULTS).collect();
        let run = |row: &usize| table.rows[*row].state == PointState::Ok && !on_front.contains(row);
        // Thinning must not leave out a default.
        let (kept, others): (Vec<usize>, Vec<usize>) = (0..table.rows.len()).filter(run).partition(|row| defaults.contains(row));
        let others = thinned(&others, MOST_ROWS - best.len() - kept.len());
        let drawn = others.into_iter().chain(kept).chain(best).collect();
        let (shown, inputs) = (drawn_columns(table, options), crate::front::input_numbers(table));
        Self { table, drawn, shown, inputs, on_front, ties, defaults, front }
    }

    /// Returns true if a row is on the front.
    pub(super) fn is_best(&self, row: usize) -> bool {
        self.on_front.contains(&row)
    }

    /// Returns true if a row equals a point on the front in every objective and has no smaller area.
    pub(super) fn is_tie(&self, row: usize) -> bool {
        self.ties.contains_key(&row)
    }

    /// Number of ties of a point on the front, or of all points.
    pub(super) fn ties(&self, point: Option<usize>) -> usize {
        self.ties.values().filter(|of| point.is_none_or(|point| **of == point)).count()
    }

    /// Returns true if the parameters of a row are as in the plan without its axes.
    pub(super) fn is_default(&self, row: usize) -> bool {
        self.defaults.contains(&row)
    }

    /// Columns that say which point it is and how good: objectives, axes, constrained figures.
    pub(super) fn summary_columns(&self) -> Vec<usize> {
        summary_columns(self.table).collect()
    }

    /// Name and unit of a column.
    pub(super) fn header(&self, column: usize) -> String {
        self.table.columns[column].header()
    }

    /// The place of a column among those shown.
    pub(super) fn drawn_index(&self, column: usize) -> Option<usize> {
        self.shown.iter().position(|shown| shown.column == column)
    }

    /// Returns the number of rows that have run.
    pub(super) fn run(&self) -> usize {
        self.table.rows.iter().filter(|row| row.state == PointState::Ok).count()
    }
}

/// Returns at most `most` of these rows, at equal distances.
pub(super) fn thinned(rows: &[usize], most: usize) -> Vec<usize> {
    let count = rows.len().min(most);
    (0..count).map(|at| rows[at * rows.len() / count]).collect()
}

fn summary_columns(table: &Table) -> impl Iterator<Item = usize> + '_ {
    let constrained = |at: &usize| table.constraints.iter().any(|rule| rule.column == table.columns[*at].name);
    let figures = (0..table.columns.len()).filter(|at| table.columns[*at].role == ColumnRole::Figure);
    table.objectives().map(|(at, _)| at).chain(table.axes()).chain(figures.filter(constrained))
}

fn drawn_columns(table: &Table, options: &PageOptions) -> Vec<DrawnColumn> {
    let asked = options.figures.iter().filter_map(|name| table.column(name));
    let mut before = BTreeSet::new();
    let columns = summary_columns(table).chain(asked).chain(0..table.columns.len()).filter(|column| before.insert(*column));
    columns.filter_map(|column| Some(DrawnColumn { column, scale: ColumnScale::of(table, column)? })).take(MOST_COLUMNS).collect()
}

/// The colour of a position.
pub(super) fn colour(at: u32) -> u32 {
    (at * COLOURS / (WHOLE + 1)).min(COLOURS - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_equal_distances() {
        assert_eq!(thinned(&[4, 5, 6, 7], 2), [4, 6]);
        assert_eq!(thinned(&[4, 5], 9), [4, 5]);
        assert!(thinned(&[], 3).is_empty() && thinned(&[1, 2], 0).is_empty());
    }

    #[test]
    fn colours_divide_the_scale_evenly() {
        assert_eq!([0, 1428, 1429, WHOLE / 2, WHOLE].map(colour), [0, 0, 1, 3, 6]);
    }
}
