//! Columns of one type each, for files that have types.

use crate::table::OWN;
use crate::table::{Cell, Row, Table};

/// Values of a column by row; `None` if a value is unknown.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ColumnValues {
    /// Counts that all fit.
    Whole(Vec<Option<i64>>),
    /// Numbers. Counts that do not fit, or that share a column with measures, are rounded to 53 bits.
    Number(Vec<Option<f64>>),
    /// Words. Numbers in a column with words are converted to text.
    Text(Vec<Option<String>>),
}

/// The columns of the CSV, under the same names.
pub(crate) fn columns(table: &Table) -> Vec<(String, ColumnValues)> {
    let own: [fn(&Row) -> &str; 3] = [|row| &row.id, |row| row.state.word(), |row| row.state.reason()];
    let known = |text: &str| Some(text.to_owned()).filter(|text| !text.is_empty());
    let own = own.map(|of| ColumnValues::Text(table.rows.iter().map(|row| known(of(row))).collect()));
    let cells = |at: usize| table.rows.iter().map(move |row| row.cells.get(at).unwrap_or(&Cell::Missing));
    let others = (0..).zip(&table.columns).map(|(at, column)| (column.header(), typed(cells(at))));
    OWN.map(str::to_owned).into_iter().zip(own).chain(others).collect()
}

/// Cells of one type: the narrowest that holds them all. A column without any value has numbers.
fn typed<'a>(cells: impl Iterator<Item = &'a Cell> + Clone) -> ColumnValues {
    let has = |is: fn(&Cell) -> bool| cells.clone().any(is);
    if has(|cell| matches!(cell, Cell::Text(_))) {
        return ColumnValues::Text(cells.map(|cell| (*cell != Cell::Missing).then(|| cell.to_string())).collect());
    }
    let is_measure =
        |cell: &Cell| matches!(cell, Cell::Number(_)) || matches!(cell, Cell::Whole(n) if i64::try_from(*n).is_err());
    if has(is_measure) || !has(|cell| *cell != Cell::Missing) {
        return ColumnValues::Number(cells.map(number).collect());
    }
    ColumnValues::Whole(cells.map(|cell| if let Cell::Whole(n) = cell { i64::try_from(*n).ok() } else { None }).collect())
}

/// Numbers that are not finite are kept, as in CSV.
fn number(cell: &Cell) -> Option<f64> {
    match cell {
        Cell::Number(x) => Some(*x),
        Cell::Whole(n) => Some(*n as f64),
        Cell::Text(_) | Cell::Missing => None,
    }
}

#[cfg(test)]
pub(crate) mod samples {
    use crate::samples::column;
    use crate::{Cell, ColumnRole, ObjectiveDirection, PointState, Row, Table};

    /// Columns of every type, and a row of each state.
    pub(crate) fn every_kind() -> Table {
        let columns = vec![
            column("cycles", "cycles", ColumnRole::Objective(ObjectiveDirection::Min)),
            column("quality.psnr_db", "dB", ColumnRole::Objective(ObjectiveDirection::Max)),
            column("a \"mode\"", "", ColumnRole::Axis),
            column("nothing", "", ColumnRole::Figure),
        ];
        let row = |id: &str, state, cells: [Cell; 3]| {
            let cells = cells.into_iter().chain([Cell::Missing]).collect();
            Row { id: id.into(), state, cells, picture: None }
        };
        let text = |text: &str| Cell::Text(text.into());
        let rows = vec![
            row("a", PointState::Ok, [Cell::Whole(7), Cell::Number(36.25), text("it's, \"x\"")]),
            row("b", PointState::Ok, [Cell::Whole(1 << 53 | 1), Cell::Number(f64::INFINITY), text("")]),
            row("c", PointState::Failed("deadlock".into()), [Cell::Missing, Cell::Missing, text("raw")]),
            row("d", PointState::Pending, [Cell::Missing, Cell::Whole(3), Cell::Missing]),
        ];
        Table { title: "every kind".into(), columns, constraints: vec![], rows }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_has_the_narrowest_type_that_holds_all_of_it() {
        let typed = |cells: &[Cell]| typed(cells.iter());
        let (one, half, word) = (Cell::Whole(1), Cell::Number(0.5), Cell::Text("x".into()));
        assert_eq!(typed(&[one.clone(), Cell::Missing]), ColumnValues::Whole(vec![Some(1), None]));
        assert_eq!(typed(&[one.clone(), half.clone()]), ColumnValues::Number(vec![Some(1.0), Some(0.5)]));
        assert_eq!(typed(&[Cell::Whole(u64::MAX), Cell::Missing]), ColumnValues::Number(vec![Some(u64::MAX as f64), None]));
        assert_eq!(
            typed(&[one, half, word, Cell::Missing]),
            ColumnValues::Text(["1", "0.5", "x"].map(|s| Some(s.into())).into_iter().chain([None]).collect())
        );
        assert_eq!(typed(&[Cell::Missing]), ColumnValues::Number(vec![None]));
    }
}
