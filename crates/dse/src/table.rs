//! A table of points: one row for each, one column for each axis, objective and figure.

use crate::rules::{Constraint, ObjectiveDirection};
use std::collections::BTreeMap;
use std::fmt;

/// Columns ahead of those of the table.
pub(crate) const OWN: [&str; 3] = ["id", "state", "reason"];
/// The one behind them, in JSON only.
pub(crate) const PICTURE: &str = "picture";
/// Names that no column of a table may have.
pub(crate) const RESERVED: [&str; 4] = [OWN[0], OWN[1], OWN[2], PICTURE];

/// Results of a sweep.
///
/// Every row has one cell per column, which [`Table::check`] checks. Names of columns are
/// unique, and none is `id`, `state`, `reason` or `picture`, which every written table has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Heading.
    pub title: String,
    /// Columns, in the order in which they are written: objectives first.
    pub columns: Vec<Column>,
    /// Constraints.
    pub constraints: Vec<Constraint>,
    /// Points, in the order of the plan.
    pub rows: Vec<Row>,
}

/// Column of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Name: of an axis the parameter, of a figure its path in the report.
    pub name: String,
    /// Unit of measure; empty for a pure number or a word.
    pub unit: String,
    /// Role of the column.
    pub role: ColumnRole,
    /// Description; may be empty.
    pub what: String,
}

/// Role of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnRole {
    /// Was chosen by the plan.
    Axis,
    /// Column to minimize or maximize.
    Objective(ObjectiveDirection),
    /// Was measured.
    Figure,
}

/// A point.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Hash of the point.
    pub id: String,
    /// State of the point.
    pub state: PointState,
    /// A value for each column.
    pub cells: Vec<Cell>,
    /// Path of the picture relative to the folder of the table, with `/` as separator.
    pub picture: Option<String>,
}

/// State of a point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PointState {
    /// The point has a report.
    Ok,
    /// The point failed for this reason. Its axes have values; other cells may have values.
    Failed(String),
    /// The point has not run yet.
    Pending,
}

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Real number. Numbers that are not finite are written, but never drawn, compared or chosen.
    Number(f64),
    /// A count.
    Whole(u64),
    /// A word: a choice, a name.
    Text(String),
    /// The value is unknown.
    Missing,
}

/// Error in a table.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TableError {
    /// A row that is too long or too short.
    #[error("row {row} (`{id}`) has {cells} cells, expected {columns}: one for each column")]
    Cells {
        /// Number of the row, from 0.
        row: usize,
        /// Hash of the row.
        id: String,
        /// Number of cells of the row.
        cells: usize,
        /// Number of columns of the table.
        columns: usize,
    },
    /// A name that two columns have.
    #[error("two columns are named `{0}`; expected a name of its own for each")]
    Name(String),
    /// A constraint names no column.
    #[error("a constraint is on `{0}`, which is no column of the table")]
    Constraint(String),
}

impl Table {
    /// The number of the column of this name, from 0.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.name == name)
    }

    /// Columns that the plan chose values for, by number.
    pub fn axes(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.columns.len()).filter(|&at| self.columns[at].role == ColumnRole::Axis)
    }

    /// Numbers the values of a column in the order of their appearance. Returns the number of each row's value.
    pub(crate) fn value_numbers(&self, column: usize) -> Vec<usize> {
        let mut numbers = BTreeMap::new();
        let mut number = |row: &Row| {
            let next = numbers.len();
            *numbers.entry(row.cells.get(column).map(Cell::to_string).unwrap_or_default()).or_insert(next)
        };
        self.rows.iter().map(&mut number).collect()
    }

    /// Objectives, with the number of their column.
    pub fn objectives(&self) -> impl Iterator<Item = (usize, ObjectiveDirection)> + '_ {
        self.columns.iter().enumerate().filter_map(|(at, column)| match column.role {
            ColumnRole::Objective(goal) => Some((at, goal)),
            ColumnRole::Axis | ColumnRole::Figure => None,
        })
    }

    /// Returns true if the point has run and meets every constraint. A cell without a finite number meets no constraint.
    pub fn feasible(&self, row: &Row) -> bool {
        let kept = |constraint: &Constraint| {
            let cell = self.column(&constraint.column).and_then(|at| row.cells.get(at));
            cell.and_then(Cell::number).is_some_and(|value| constraint.keeps(value))
        };
        row.state == PointState::Ok && self.constraints.iter().all(kept)
    }

    /// That rows have a cell for each column, names of columns are different, and constraints are on columns.
    ///
    /// # Errors
    /// The first that is wrong.
    pub fn check(&self) -> Result<(), TableError> {
        let names = || RESERVED.into_iter().chain(self.columns.iter().map(|column| column.name.as_str()));
        if let Some((_, name)) = names().enumerate().find(|(at, name)| names().take(*at).any(|before| before == *name)) {
            return Err(TableError::Name(name.into()));
        }
        if let Some(constraint) = self.constraints.iter().find(|constraint| self.column(&constraint.column).is_none()) {
            return Err(TableError::Constraint(constraint.column.clone()));
        }
        let columns = self.columns.len();
        match self.rows.iter().enumerate().find(|(_, row)| row.cells.len() != columns) {
            Some((row, Row { id, cells, .. })) => Err(TableError::Cells { row, id: id.clone(), cells: cells.len(), columns }),
            None => Ok(()),
        }
    }
}

impl Column {
    /// Returns name and unit, as in `cycles.total [cycles]`, or the name if the column has no unit.
    pub fn header(&self) -> String {
        if self.unit.is_empty() { self.name.clone() } else { format!("{} [{}]", self.name, self.unit) }
    }
}

impl Cell {
    /// The value as a finite number, if it is one. Counts beyond 2^53 are rounded.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Number(x) => Some(*x).filter(|x| x.is_finite()),
            Self::Whole(n) => Some(*n as f64),
            Self::Text(_) | Self::Missing => None,
        }
    }
}

/// Formats a number with the fewest digits that read back to the same value.
impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            // The debug form writes long numbers with an exponent; 1e300 has 301 digits.
            Self::Number(x) => write!(f, "{x:?}"),
            Self::Whole(n) => n.fmt(f),
            Self::Text(text) => f.write_str(text),
            Self::Missing => Ok(()),
        }
    }
}

impl PointState {
    /// Returns `ok`, `failed` or `pending`.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Failed(_) => "failed",
            Self::Pending => "pending",
        }
    }

    /// Why it failed; empty where it has not.
    pub fn reason(&self) -> &str {
        if let Self::Failed(reason) = self { reason } else { "" }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(cells: Vec<Cell>) -> Table {
        let column = |name: &str, role| Column { name: name.into(), unit: "".into(), role, what: "".into() };
        Table {
            title: "t".into(),
            columns: vec![column("cycles", ColumnRole::Objective(ObjectiveDirection::Min)), column("lanes", ColumnRole::Axis)],
            constraints: vec!["cycles < 10".parse().unwrap()],
            rows: vec![Row { id: "a".into(), state: PointState::Ok, cells, picture: None }],
        }
    }

    #[test]
    fn feasible_points_ran_and_meet_constraints() {
        let feasible = |cell: Cell, state: PointState| {
            let mut table = table(vec![cell, Cell::Text("x".into())]);
            table.rows[0].state = state;
            table.feasible(&table.rows[0])
        };
        assert!(feasible(Cell::Whole(9), PointState::Ok) && feasible(Cell::Number(9.5), PointState::Ok));
        assert!(!feasible(Cell::Whole(10), PointState::Ok) && !feasible(Cell::Missing, PointState::Ok));
        assert!(!feasible(Cell::Number(f64::NEG_INFINITY), PointState::Ok) && !feasible(Cell::Text("9".into()), PointState::Ok));
        assert!(
            !feasible(Cell::Whole(9), PointState::Failed("deadlock".into())) && !feasible(Cell::Whole(9), PointState::Pending)
        );
    }

    #[test]
    fn a_table_says_where_it_is_wrong() {
        let good = table(vec![Cell::Missing, Cell::Missing]);
        assert_eq!(good.check(), Ok(()));
        assert_eq!(
            (good.axes().collect::<Vec<_>>(), good.objectives().collect::<Vec<_>>()),
            (vec![1], vec![(0, ObjectiveDirection::Min)])
        );
        let error = table(vec![]).check().unwrap_err().to_string();
        assert_eq!(error, "row 0 (`a`) has 0 cells, expected 2: one for each column");
        let mut twice = good.clone();
        twice.columns[1].name = "cycles".into();
        assert_eq!(twice.check(), Err(TableError::Name("cycles".into())));
        twice.columns[1].name = "state".into();
        assert_eq!(twice.check(), Err(TableError::Name("state".into())));
        let mut unknown = good;
        unknown.constraints[0].column = "bits".into();
        assert_eq!(unknown.check(), Err(TableError::Constraint("bits".into())));
    }
}
