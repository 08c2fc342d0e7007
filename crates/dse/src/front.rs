//! Pareto-optimal points.
//!
//! A point *dominates* another if it is at least as good by every objective and better by one. Points that no point dominates are
//! Pareto-optimal; together they are the Pareto front. Only [`candidates`] count: rows that have run, keep every constraint and have a finite number for every
//! objective. Of points that are equal by every objective, the one with the smallest area is on the front, and the first of equal
//! areas; the others are its [ties](FrontPoint::ties).
//!
//! A table of several inputs has one front per input: another scene is no better design.

use crate::rules::ObjectiveDirection;
use crate::table::{Cell, ColumnRole, Table};
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Column of the area.
const AREA: &str = "hardware.area_ge";
/// Column of the inputs, in tables of several inputs.
pub(crate) const INPUT: &str = "input";

/// A point of a front.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrontPoint {
    /// Number of its row.
    pub row: usize,
    /// Rows that are equal by every objective and have no smaller area, in the order of the table.
    pub ties: Vec<usize>,
}

/// Rows that may be chosen, by number, each with its costs: a value per objective, of which the smaller is better. None if the
/// table has no objective.
pub fn candidates(table: &Table) -> Vec<(usize, Vec<f64>)> {
    candidates_by(table, &table.objectives().collect::<Vec<_>>())
}

/// Returns [`candidates`] by these objectives only.
fn candidates_by(table: &Table, objectives: &[(usize, ObjectiveDirection)]) -> Vec<(usize, Vec<f64>)> {
    let costs = |cells: &[Cell]| -> Option<Vec<f64>> {
        objectives.iter().map(|&(at, goal)| Some(goal.cost(cells.get(at)?.number()?))).collect()
    };
    if objectives.is_empty() {
        return vec![];
    }
    let feasible = table.rows.iter().enumerate().filter(|(_, row)| table.feasible(row));
    feasible.filter_map(|(number, row)| Some((number, costs(&row.cells)?))).collect()
}

/// Returns the numbers of the Pareto-optimal rows, in the order of the table.
///
/// ```
/// use basrelief_dse::{Cell, Column, ColumnRole, ObjectiveDirection, PointState, Row, Table, front};
///
/// let column = |name: &str, goal| Column { name: name.into(), unit: "".into(), role: ColumnRole::Objective(goal), what: "".into() };
/// let row = |cycles, db| Row {
///     id: format!("{cycles}"),
///     state: PointState::Ok,
///     cells: vec![Cell::Whole(cycles), Cell::Number(db)],
///     picture: None,
/// };
/// let table = Table {
///     columns: vec![column("cycles", ObjectiveDirection::Min), column("psnr_db", ObjectiveDirection::Max)],
///     rows: vec![row(100, 20.0), row(300, 30.0), row(200, 19.0), row(300, 30.0)],
///     ..Table::default()
/// };
/// // The third takes longer than the first and is worse; the last is equal to the second, so it is not listed.
/// assert_eq!(front(&table), [0, 1]);
/// ```
pub fn front(table: &Table) -> Vec<usize> {
    front_by(table, &table.objectives().collect::<Vec<_>>())
}

/// Returns the Pareto-optimal rows with their ties, in the order of the table.
pub fn front_points(table: &Table) -> Vec<FrontPoint> {
    points_by(table, &table.objectives().collect::<Vec<_>>())
}

/// Returns [`front`] by these objectives only.
pub(crate) fn front_by(table: &Table, objectives: &[(usize, ObjectiveDirection)]) -> Vec<usize> {
    points_by(table, objectives).into_iter().map(|point| point.row).collect()
}

/// Returns the column of the inputs of a table of several inputs.
pub(crate) fn input_column(table: &Table) -> Option<usize> {
    table.columns.iter().position(|column| column.name == INPUT && column.role == ColumnRole::Axis)
}

/// Returns the number of each row's input, in order of the rows; 0 if there is only one.
pub(crate) fn input_numbers(table: &Table) -> Vec<usize> {
    input_column(table).map_or_else(|| vec![0; table.rows.len()], |column| table.value_numbers(column))
}

fn points_by(table: &Table, objectives: &[(usize, ObjectiveDirection)]) -> Vec<FrontPoint> {
    let inputs = input_numbers(table);
    let mut of_inputs: BTreeMap<usize, Vec<(usize, Vec<f64>)>> = BTreeMap::new();
    for (row, costs) in candidates_by(table, objectives) {
        of_inputs.entry(inputs[row]).or_default().push((row, costs));
    }
    let mut points: Vec<FrontPoint> = of_inputs.into_values().flat_map(|of_input| points_among(table, of_input)).collect();
    points.sort_by_key(|point| point.row);
    points
}

/// Returns the Pareto-optimal rows among these, each with its costs.
fn points_among(table: &Table, candidates: Vec<(usize, Vec<f64>)>) -> Vec<FrontPoint> {
    let (rows, costs): (Vec<usize>, Vec<Vec<f64>>) = candidates.into_iter().unzip();
    let area_column = table.columns.iter().position(|column| column.name == AREA);
    let area = |at: usize| area_column.and_then(|column| table.rows[rows[at]].cells[column].number()).unwrap_or(f64::INFINITY);
    let mut optimal = nondominated(&costs);
    optimal.sort_by(|&a, &b| lexicographic(&costs[a], &costs[b]).then(area(a).total_cmp(&area(b))).then(a.cmp(&b)));
    let point = |equal: &[usize]| {
        let mut ties: Vec<usize> = equal[1..].iter().map(|at| rows[*at]).collect();
        ties.sort_unstable();
        FrontPoint { row: rows[equal[0]], ties }
    };
    optimal.chunk_by(|&a, &b| costs[a] == costs[b]).map(point).collect()
}

/// Returns true if costs `a` are at most costs `b` everywhere, and less somewhere.
pub fn dominates(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| a <= b) && a.iter().zip(b).any(|(a, b)| a < b)
}

/// Places of the costs that no others dominate, ascending. All have the same length, and numbers that are finite.
///
/// Takes time in proportion to n log n up to three objectives, beyond that to n times the points on the front.
pub fn nondominated(costs: &[impl AsRef<[f64]>]) -> Vec<usize> {
    let of = |at: usize| costs[at].as_ref();
    let mut order: Vec<usize> = (0..costs.len()).collect();
    order.sort_by(|&a, &b| lexicographic(of(a), of(b)));
    let (mut seen, mut front) = (FrontIndex::default(), vec![]);
    // In this order, dominating points precede a point, and equal points are adjacent.
    for equal in order.chunk_by(|&a, &b| of(a) == of(b)) {
        if seen.add(of(equal[0])) {
            front.extend_from_slice(equal);
        }
    }
    front.sort_unstable();
    front
}

/// Points of a front, in lexicographic order.
#[derive(Default)]
struct FrontIndex<'a> {
    /// With up to three costs: the second and third costs of points that no other point dominates in both, sorted by the second.
    stair: Vec<[f64; 2]>,
    /// With more costs: all points.
    points: Vec<&'a [f64]>,
}

impl<'a> FrontIndex<'a> {
    /// Adds a point unless one of those before dominates it; whether it has.
    fn add(&mut self, costs: &'a [f64]) -> bool {
        if costs.len() > 3 {
            // The latest are the nearest, and most often those that dominate.
            let free = !self.points.iter().rev().any(|other| dominates(other, costs));
            self.points.extend(free.then_some(costs));
            return free;
        }
        // The first cost of all before is no higher.
        let [second, third] = [1, 2].map(|at| costs.get(at).copied().unwrap_or(0.0));
        let before = self.stair.partition_point(|step| step[0] <= second);
        let free = before == 0 || self.stair[before - 1][1] > third;
        if free {
            let from = self.stair.partition_point(|step| step[0] < second);
            let covered = self.stair[from..].iter().take_while(|step| step[1] >= third).count();
            self.stair.splice(from..from + covered, [[second, third]]);
        }
        free
    }
}

/// Compares lists by the first number, then the second, and so on. Zeros of either sign are equal.
pub(crate) fn lexicographic(a: &[f64], b: &[f64]) -> Ordering {
    a.partial_cmp(b).unwrap_or(Ordering::Equal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Column, PointState, Row};
    use proptest::prelude::*;

    /// Generates costs with few different values, so that ties occur.
    pub(crate) fn costs() -> impl Strategy<Value = Vec<Vec<f64>>> {
        let number = (0u8..6).prop_map(f64::from);
        (1usize..5).prop_flat_map(move |n| prop::collection::vec(prop::collection::vec(number.clone(), n), 0..40))
    }

    proptest! {
        #[test]
        fn front_is_not_dominated(costs in costs()) {
            let free = |at: &usize| !costs.iter().any(|other| dominates(other, &costs[*at]));
            let expected: Vec<usize> = (0..costs.len()).filter(free).collect();
            prop_assert_eq!(nondominated(&costs), expected);
        }
    }

    #[test]
    fn only_candidates_are_on_the_front() {
        let columns =
            [ColumnRole::Objective(ObjectiveDirection::Min), ColumnRole::Objective(ObjectiveDirection::Max), ColumnRole::Figure];
        let column = |(at, role)| Column { name: format!("c{at}"), unit: "".into(), role, what: "".into() };
        let row = |cells: [Cell; 3]| Row { id: "".into(), state: PointState::Ok, cells: cells.into(), picture: None };
        let figure = |cycles, db, bits| row([Cell::Whole(cycles), Cell::Number(db), Cell::Whole(bits)]);
        let mut table = Table {
            columns: columns.into_iter().enumerate().map(column).collect(),
            constraints: vec!["c2 <= 8".parse().unwrap()],
            rows: vec![
                figure(1, 9.0, 9),
                figure(1, f64::NAN, 1),
                figure(1, f64::INFINITY, 1),
                row([Cell::Whole(1), Cell::Missing, Cell::Whole(1)]),
                figure(2, 8.0, 8),
                figure(0, 99.0, 8),
                figure(3, 8.0, 8),
            ],
            ..Table::default()
        };
        table.rows[5].state = PointState::Failed("deadlock".into());
        assert_eq!(front(&table), [4]);
        assert_eq!(candidates(&table), [(4, vec![2.0, -8.0]), (6, vec![3.0, -8.0])]);
        table.constraints.clear();
        assert_eq!(front(&table), [0]);
        table.columns.iter_mut().for_each(|column| column.role = ColumnRole::Figure);
        assert!(front(&table).is_empty());
    }

    // Claim: analysis: Of designs that are equal by every objective, the one with the smallest area is on the front.
    #[test]
    fn cheapest_of_equal_designs_is_on_the_front() {
        let column = |name: &str, role| Column { name: name.into(), unit: "".into(), role, what: "".into() };
        let row = |cycles, area| Row {
            id: "".into(),
            state: PointState::Ok,
            cells: vec![Cell::Whole(cycles), Cell::Whole(area)],
            picture: None,
        };
        let columns = vec![
            column("cycles", ColumnRole::Objective(ObjectiveDirection::Min)),
            column("hardware.area_ge", ColumnRole::Figure),
        ];
        let rows = vec![row(5, 40), row(9, 1), row(5, 20), row(5, 30), row(5, 20)];
        let table = Table { columns, rows, ..Table::default() };
        assert_eq!(front_points(&table), [FrontPoint { row: 2, ties: vec![0, 3, 4] }]);
        assert_eq!(front(&table), [2]);
    }

    // Claim: analysis: Points of different inputs do not dominate each other.
    #[test]
    fn each_input_has_its_own_front() {
        let column = |name: &str, role| Column { name: name.into(), unit: "".into(), role, what: "".into() };
        let row = |cycles, input: &str| Row {
            id: "".into(),
            state: PointState::Ok,
            cells: vec![Cell::Whole(cycles), Cell::Text(input.into())],
            picture: None,
        };
        let columns = vec![column("cycles", ColumnRole::Objective(ObjectiveDirection::Min)), column(INPUT, ColumnRole::Axis)];
        let rows = vec![row(5, "ball"), row(90, "room"), row(7, "ball"), row(80, "room"), row(5, "room"), row(5, "ball")];
        let mut table = Table { columns, rows, ..Table::default() };
        assert_eq!(input_numbers(&table), [0, 1, 0, 1, 1, 0]);
        assert_eq!(front_points(&table), [FrontPoint { row: 0, ties: vec![5] }, FrontPoint { row: 4, ties: vec![] }]);
        table.columns.pop();
        assert_eq!(front_points(&table), [FrontPoint { row: 0, ties: vec![4, 5] }]);
    }

    #[test]
    fn long_fronts_are_found() {
        // A comparison of each pair would take minutes.
        let stair: Vec<[f64; 2]> = (0..100_000).map(|at| [f64::from(at), f64::from(-at)]).collect();
        assert_eq!(nondominated(&stair).len(), 100_000);
        let plane: Vec<[f64; 3]> = (0..300).flat_map(|x| (0..300).map(move |y| [x, y, -x - y].map(f64::from))).collect();
        assert_eq!(nondominated(&plane).len(), 90_000);
    }

    #[test]
    fn zeros_of_either_sign_are_equal() {
        assert_eq!(nondominated(&[[0.0, 1.0], [-0.0, 1.0], [-0.0, 0.5]]), [2]);
    }
}
