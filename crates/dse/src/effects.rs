//! Main effects: range of an objective over the values of an axis, averaged over the other axes.
//!
//! For each value of an axis, the mean and the best of an objective are taken over all points with that value. The distance from the
//! lowest to the highest mean is the effect of the axis: the length of its bar in a tornado chart. A whole grid is balanced, so the
//! effect comes from this axis only. A sample adds noise, which shrinks with the number of points. Interactions of two axes do not
//! show here; a heat map of both shows them.
//!
//! Axes that change together, such as the parameters of a `[[zip]]`, count as one axis: no point tells their effects apart.
//!
//! If every point differs from the first point in at most one axis, points that differ in another axis are left out: the effect of an
//! axis is then relative to the first point only.

use crate::levels::ColumnLevels;
use crate::rules::ObjectiveDirection;
use crate::table::{PointState, Row, Table};

/// Effect of an axis on an objective.
#[derive(Clone, Debug, PartialEq)]
pub struct Effect {
    /// Number of the axis's column.
    pub axis: usize,
    /// Columns of the axes that change together with it.
    pub tied: Vec<usize>,
    /// Number of the objective's column.
    pub objective: usize,
    /// Means by level of the axis, in order. An axis of more than twelve values has several values per level.
    pub levels: Vec<ValueEffect>,
}

/// Points of one value of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct ValueEffect {
    /// The value; `first to last` of several.
    pub label: String,
    /// Points with it, one at least.
    pub points: usize,
    /// Mean of the objective, in its unit.
    pub mean: f64,
    /// Best value of the objective on this level.
    pub best: f64,
}

impl Effect {
    /// The levels of lowest and highest mean.
    pub fn extreme_levels(&self) -> Option<(&ValueEffect, &ValueEffect)> {
        let by_mean = |a: &&ValueEffect, b: &&ValueEffect| a.mean.total_cmp(&b.mean);
        Some((self.levels.iter().min_by(by_mean)?, self.levels.iter().max_by(by_mean)?))
    }

    /// Returns the difference between the highest and the lowest mean, in the unit of the objective.
    pub fn mean_range(&self) -> f64 {
        self.extreme_levels().map_or(0.0, |(low, high)| high.mean - low.mean)
    }

    /// Returns the difference between the highest and the lowest best value.
    pub fn best_moved(&self) -> f64 {
        let best = || self.levels.iter().map(|level| level.best);
        best().reduce(f64::max).zip(best().reduce(f64::min)).map_or(0.0, |(high, low)| high - low)
    }
}

/// Effects of all axes on all objectives: by objective in the order of the table, of each the largest first, equal ones in the
/// order of the table. Counted are all points that have run, whether they keep the constraints or not.
pub fn effects(table: &Table) -> Vec<Effect> {
    let axes: Vec<(Vec<usize>, ColumnLevels)> =
        tied_axes(table).into_iter().map(|tied| (tied.clone(), ColumnLevels::of(table, tied[0]))).collect();
    let star = is_star(table);
    let counts = |axis: usize, row: &usize| !star || *row == 0 || table.rows[*row].cells[axis] != table.rows[0].cells[axis];
    let of = |(objective, goal)| {
        let effect = |(axes, levels): &(Vec<usize>, ColumnLevels)| Effect {
            axis: axes[0],
            tied: axes[1..].to_vec(),
            objective,
            levels: levels
                .labels
                .iter()
                .zip(levels.rows())
                .filter_map(|(label, mut rows)| {
                    rows.retain(|row| counts(axes[0], row));
                    level(table, objective, goal, label, &rows)
                })
                .collect(),
        };
        let mut effects: Vec<Effect> = axes.iter().map(effect).collect();
        effects.sort_by(|a, b| b.mean_range().total_cmp(&a.mean_range()));
        effects
    };
    table.objectives().flat_map(of).collect()
}

/// Groups the axes that change together: the value of one gives the value of the other, in both directions. Axes with one value are
/// groups of their own.
fn tied_axes(table: &Table) -> Vec<Vec<usize>> {
    let mut groups: Vec<(Vec<usize>, Vec<usize>)> = vec![];
    for axis in table.axes() {
        // Values that change together appear together for the first time, so they have the same number.
        let values = table.value_numbers(axis);
        let has_several = values.iter().any(|value| *value > 0);
        match groups.iter_mut().find(|(first, _)| has_several && *first == values) {
            Some((_, group)) => group.push(axis),
            None => groups.push((values, vec![axis])),
        }
    }
    groups.into_iter().map(|(_, group)| group).collect()
}

/// Returns true if the points that have run are a whole grid, so that an effect comes from its axis only.
pub(crate) fn is_whole_grid(table: &Table) -> bool {
    let count = |tied: Vec<usize>| table.value_numbers(tied[0]).into_iter().max().map_or(0, |last| last + 1);
    let points = table.rows.iter().filter(|row| row.state == PointState::Ok).count();
    tied_axes(table).into_iter().map(count).try_fold(1, usize::checked_mul) == Some(points)
}

/// Returns true if each point differs from the first point in at most one axis.
fn is_star(table: &Table) -> bool {
    let Some((first, others)) = table.rows.split_first() else { return false };
    let changed = |row: &Row| table.axes().filter(|&axis| row.cells[axis] != first.cells[axis]).count();
    others.iter().all(|row| changed(row) <= 1)
}

/// Returns `None` if no point of these rows has run.
pub(crate) fn level(
    table: &Table,
    objective: usize,
    goal: ObjectiveDirection,
    label: &str,
    rows: &[usize],
) -> Option<ValueEffect> {
    let run = rows.iter().map(|&row| &table.rows[row]).filter(|row| row.state == PointState::Ok);
    let mut values: Vec<f64> = run.filter_map(|row| row.cells.get(objective)?.number()).collect();
    let best = values.iter().copied().reduce(|a, b| if goal.better(b, a) { b } else { a })?;
    // Equal values have an equal mean in any order, so an axis without effect has an effect of exactly 0.
    values.sort_by(f64::total_cmp);
    // Each divided first: a sum of large values must not overflow.
    let mean = values.iter().map(|value| value / values.len() as f64).sum();
    Some(ValueEffect { label: label.into(), points: values.len(), mean, best })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cell, Column, ColumnRole};

    /// cycles = 100 a + 10 b, dB = b, over a 3 x 4 grid.
    fn grid() -> Table {
        let column = |(name, role): (&str, ColumnRole)| Column { name: name.into(), unit: "".into(), role, what: "".into() };
        let roles = [
            ColumnRole::Objective(ObjectiveDirection::Min),
            ColumnRole::Objective(ObjectiveDirection::Max),
            ColumnRole::Axis,
            ColumnRole::Axis,
        ];
        let cells = |a: u64, b: u64| vec![Cell::Whole(100 * a + 10 * b), Cell::Number(b as f64), Cell::Whole(a), Cell::Whole(b)];
        let row = |(a, b)| Row { id: format!("{a}{b}"), state: PointState::Ok, cells: cells(a, b), picture: None };
        Table {
            columns: ["cycles", "dB", "a", "b"].into_iter().zip(roles).map(column).collect(),
            rows: (0..3).flat_map(|a| (0..4).map(move |b| (a, b))).map(row).collect(),
            ..Table::default()
        }
    }

    #[test]
    fn the_axis_that_moves_most_comes_first() {
        let effects = effects(&grid());
        let told: Vec<_> = effects.iter().map(|e| (e.objective, e.axis, e.mean_range(), e.best_moved())).collect();
        assert_eq!(told, [(0, 2, 200.0, 200.0), (0, 3, 30.0, 30.0), (1, 3, 3.0, 3.0), (1, 2, 0.0, 0.0)]);
        let (low, high) = effects[0].extreme_levels().unwrap();
        assert_eq!((low, high.label.as_str()), (&ValueEffect { label: "0".into(), points: 4, mean: 15.0, best: 0.0 }, "2"));
        assert_eq!(effects[3].levels[0].best, 3.0);
    }

    /// Axis `b` of the grid, and an axis that changes with it.
    #[test]
    fn axes_that_change_together_are_one_axis() {
        let mut table = grid();
        assert!(is_whole_grid(&table));
        table.columns.push(Column { name: "c".into(), ..table.columns[3].clone() });
        for row in &mut table.rows {
            let Cell::Whole(b) = row.cells[3] else { panic!("{row:?}") };
            row.cells.push(Cell::Text(format!("value {b}")));
        }
        let told: Vec<_> = effects(&table).into_iter().take(2).map(|e| (e.axis, e.tied, e.levels.len())).collect();
        assert_eq!(told, [(2, vec![], 3), (3, vec![4], 4)]);
        assert!(is_whole_grid(&table));
        table.rows[0].state = PointState::Pending;
        assert!(!is_whole_grid(&table));
        table.rows[0].state = PointState::Ok;
        table.rows.remove(5);
        assert!(!is_whole_grid(&table));
        assert_eq!(effects(&table)[1].tied, [4]);
    }

    #[test]
    fn an_axis_without_effect_moves_nothing_at_all() {
        let mut table = grid();
        for row in &mut table.rows {
            let (Cell::Whole(a), Cell::Whole(b)) = (&row.cells[2], &row.cells[3]) else { panic!("{row:?}") };
            // Along `a` the same values in another order, by which their sum would differ.
            row.cells[0] = Cell::Number(if (a + b) % 4 == 0 { 1e16 } else { 1.0 });
        }
        let moved: Vec<f64> =
            effects(&table).iter().filter(|effect| effect.axis == 2 && effect.objective == 0).map(Effect::mean_range).collect();
        assert_eq!(moved, [0.0]);
    }

    #[test]
    fn around_a_first_point_others_say_nothing_of_an_axis() {
        let mut table = grid();
        // (0, 0), (0, 1) ... (0, 3), (1, 0), (2, 0): along `a` from 0 to 200, along `b` from 0 to 30.
        table.rows.retain(|row| row.id.contains('0'));
        let told: Vec<_> = effects(&table).iter().take(2).map(|e| (e.axis, e.mean_range(), e.levels[0].points)).collect();
        assert_eq!(told, [(2, 200.0, 1), (3, 30.0, 1)]);
        // With one more point it is no such plan, so means are over all points with a value.
        table.rows.push(grid().rows[5].clone());
        assert_eq!(effects(&table)[0].levels[0].points, 4);
    }

    #[test]
    fn failed_points_move_nothing() {
        let mut table = grid();
        table.rows.iter_mut().take(4).for_each(|row| row.state = PointState::Failed("deadlock".into()));
        let effects = effects(&table);
        assert_eq!((effects[0].mean_range(), effects[0].levels.len()), (100.0, 2));
        table.rows.clear();
        assert!(super::effects(&table).iter().all(|effect| effect.mean_range() == 0.0 && effect.extreme_levels().is_none()));
    }
}
