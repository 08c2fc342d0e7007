//! Ranges of columns, and the levels of an axis.

use crate::table::{Cell, Table};
use std::collections::BTreeMap;

/// Maximum number of levels of an axis. If an axis has more values, several neighbouring values form one level.
pub(crate) const MOST: usize = 12;

/// A scale is logarithmic from this ratio of largest to smallest value on.
const LOGARITHMIC: f64 = 10.0;

/// Lowest and highest of finite numbers.
pub(crate) fn range(numbers: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    numbers.fold(None, |range, x| range.map_or(Some((x, x)), |(low, high): (f64, f64)| Some((low.min(x), high.max(x)))))
}

/// Returns true if a scale between these ends should be logarithmic.
pub(crate) fn logarithmic((low, high): (f64, f64)) -> bool {
    low > 0.0 && high / low >= LOGARITHMIC
}

/// Values of a column: numbers in ascending order, then words in the order of their first row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ColumnLevels {
    /// Each in words; of several values the first and the last.
    pub(crate) labels: Vec<String>,
    /// Level of each row; `None` if its value is unknown.
    pub(crate) of_row: Vec<Option<usize>>,
    /// True if each level has one value.
    pub(crate) single: bool,
}

impl ColumnLevels {
    pub(crate) fn of(table: &Table, column: usize) -> Self {
        let mut words = BTreeMap::new();
        let mut keyed: Vec<((u8, f64), usize)> = vec![];
        for (row, cells) in table.rows.iter().map(|row| &row.cells).enumerate() {
            keyed.extend(cells.get(column).and_then(|cell| Some((key(cell, &mut words)?, row))));
        }
        keyed.sort_by(|((kind_a, a), _), ((kind_b, b), _)| kind_a.cmp(kind_b).then(a.total_cmp(b)));
        let values: Vec<&[((u8, f64), usize)]> = keyed.chunk_by(|(a, _), (b, _)| a == b).collect();
        let per = values.len().div_ceil(MOST).max(1);
        let mut of_row = vec![None; table.rows.len()];
        for (level, (_, row)) in values.iter().enumerate().flat_map(|(at, value)| value.iter().map(move |of| (at / per, of))) {
            of_row[*row] = Some(level);
        }
        let told = |value: &[(_, usize)]| table.rows[value[0].1].cells[column].to_string();
        let label = |values: &[&[_]]| match values {
            [one] => told(one),
            [first, .., last] => format!("{} to {}", told(first), told(last)),
            [] => String::new(),
        };
        Self { labels: values.chunks(per).map(label).collect(), of_row, single: per == 1 }
    }

    /// Numbers of the rows of each level.
    pub(crate) fn rows(&self) -> Vec<Vec<usize>> {
        let mut rows = vec![vec![]; self.labels.len()];
        for (row, level) in self.of_row.iter().enumerate() {
            if let Some(level) = level {
                rows[*level].push(row);
            }
        }
        rows
    }
}

/// Sort key of a cell.
fn key<'a>(cell: &'a Cell, words: &mut BTreeMap<&'a str, usize>) -> Option<(u8, f64)> {
    if let Cell::Text(word) = cell {
        let next = words.len();
        return Some((1, *words.entry(word).or_insert(next) as f64));
    }
    // Zeros of either sign are one value.
    cell.number().map(|x| (0, x + 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PointState, Row};

    fn levels(cells: impl IntoIterator<Item = Cell>) -> ColumnLevels {
        let row = |cell| Row { id: String::new(), state: PointState::Ok, cells: vec![cell], picture: None };
        ColumnLevels::of(&Table { rows: cells.into_iter().map(row).collect(), ..Table::default() }, 0)
    }

    #[test]
    fn numbers_ascend_and_words_keep_their_order() {
        let text = |word: &str| Cell::Text(word.into());
        let cells = [text("low"), Cell::Whole(4), Cell::Missing, Cell::Number(0.5), text("high"), Cell::Number(4.0), text("low")];
        let found = levels(cells);
        assert_eq!(found.labels, ["0.5", "4", "low", "high"]);
        assert_eq!(found.of_row, [Some(2), Some(1), None, Some(0), Some(3), Some(1), Some(2)]);
        assert_eq!((found.rows(), found.single), (vec![vec![3], vec![1, 5], vec![0, 6], vec![4]], true));
        assert_eq!(levels([Cell::Number(f64::NAN), Cell::Number(-0.0), Cell::Number(0.0)]).labels, ["-0.0"]);
    }

    #[test]
    fn many_values_share_levels() {
        let found = levels((0..30).map(Cell::Whole));
        assert_eq!((found.labels[0].as_str(), found.labels.len(), found.single), ("0 to 2", 10, false));
        assert_eq!((found.of_row[2], found.of_row[29]), (Some(0), Some(9)));
        assert!(levels([]).labels.is_empty());
    }
}
