//! Labels: values in words, and texts shortened to fit.

use crate::table::Cell;
use basrelief_report::number::{real, thousands};

/// Unit of measure of values with two decimals: more say nothing.
const DECIBEL: &str = "dB";

/// A cell: counts with thousands separators, measures with up to six decimals, decibels with two.
pub(super) fn cell(cell: &Cell, unit: &str) -> String {
    match cell {
        Cell::Number(x) if unit == DECIBEL && x.is_finite() => format!("{x:.2}"),
        Cell::Whole(n) => thousands(*n),
        Cell::Number(x) if *x == 0.0 || (1e-3..1e15).contains(&x.abs()) => real(*x),
        Cell::Missing => "-".into(),
        Cell::Number(_) | Cell::Text(_) => cell.to_string(),
    }
}

/// Formats a number with four digits, from a thousand on as a whole number; decibels with two decimals.
pub(super) fn rounded(x: f64, unit: &str) -> String {
    if unit == DECIBEL {
        return format!("{x:.2}");
    }
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

/// Formats like [`rounded`], with large numbers in thousands, millions or more, for narrow places.
pub(super) fn compact(x: f64) -> String {
    let (unit, suffix) = unit(x.abs());
    format!("{}{suffix}", rounded(x / unit, ""))
}

/// Unit of large numbers.
pub(super) fn unit(largest: f64) -> (f64, &'static str) {
    let units = [(1e9, " G"), (1e6, " M"), (1e4, " k")];
    let found = units.into_iter().find(|(least, _)| (*least..1e12).contains(&largest));
    found.map_or((1.0, ""), |(least, suffix)| if least == 1e4 { (1e3, suffix) } else { (least, suffix) })
}

/// A label that fits into so much room.
pub(super) fn shortened(text: &str, room: f64) -> String {
    let most = ((room / 6.8) as usize).max(3);
    if text.chars().count() <= most { text.into() } else { text.chars().take(most - 1).chain(['…']).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_as_many_digits_as_say_something() {
        let written = [0.0, 874_574.4, 123.456, 27.6512, -1.23456, 0.5, 1e-9, 1e20].map(|x| rounded(x, ""));
        assert_eq!(written, ["0", "874,574", "123.5", "27.65", "-1.235", "0.5", "1.000e-9", "1.000e20"]);
        assert_eq!([155_507_392.0, -20_000.0, 27.6512].map(compact), ["155.5 M", "-20 k", "27.65"]);
        assert_eq!([25.532577, 8.0, 0.0].map(|x| rounded(x, DECIBEL)), ["25.53", "8.00", "0.00"]);
        assert_eq!([Cell::Number(25.532577), Cell::Number(8.0)].map(|c| cell(&c, DECIBEL)), ["25.53", "8.00"]);
        let cells = [Cell::Whole(1234), Cell::Number(27.651234), Cell::Number(1e-9), Cell::Number(f64::INFINITY), Cell::Missing];
        assert_eq!(cells.map(|c| cell(&c, "cycles")), ["1,234", "27.651234", "1e-9", "inf", "-"]);
    }
}
