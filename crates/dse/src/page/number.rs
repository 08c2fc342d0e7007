//! Values of cells as people read them.

use super::scale::unit;
use crate::table::Cell;
use basrelief_report::number::{real, thousands};

/// A cell: counts with thousands separators, measures with up to six decimals.
pub(super) fn cell(cell: &Cell) -> String {
    match cell {
        Cell::Whole(n) => thousands(*n),
        Cell::Number(x) if *x == 0.0 || (1e-3..1e15).contains(&x.abs()) => real(*x),
        Cell::Missing => "-".into(),
        Cell::Number(_) | Cell::Text(_) => cell.to_string(),
    }
}

/// A number to four digits, whole ones from a thousand on.
pub(super) fn rounded(x: f64) -> String {
    let size = x.abs();
    let decimals = match size {
        _ if size >= 1e15 || size < 1e-3 && size > 0.0 => return format!("{x:.3e}"),
        _ if size >= 1e3 => 0,
        _ if size >= 1e2 => 1,
        _ if size >= 1e1 => 2,
        _ => 3,
    };
    // Rounded by its decimals, then written as any other number.
    real(format!("{x:.decimals$}").parse().unwrap_or(x))
}

/// As [`rounded`], large ones in thousands, millions or more: for narrow places.
pub(super) fn compact(x: f64) -> String {
    let (unit, suffix) = unit(x.abs());
    format!("{}{suffix}", rounded(x / unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_as_many_digits_as_say_something() {
        let written = [0.0, 874_574.4, 123.456, 27.6512, -1.23456, 0.5, 1e-9, 1e20].map(rounded);
        assert_eq!(written, ["0", "874,574", "123.5", "27.65", "-1.235", "0.5", "1.000e-9", "1.000e20"]);
        assert_eq!([155_507_392.0, -20_000.0, 27.6512].map(compact), ["155.5 M", "-20 k", "27.65"]);
        let cells = [Cell::Whole(1234), Cell::Number(27.651234), Cell::Number(1e-9), Cell::Number(f64::INFINITY), Cell::Missing];
        assert_eq!(cells.map(|c| cell(&c)), ["1,234", "27.651234", "1e-9", "inf", "-"]);
    }
}
