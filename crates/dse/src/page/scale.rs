//! Positions of the values of a column along an axis, and their tick labels.

use super::labels::{rounded, unit};
use crate::levels::{ColumnLevels, logarithmic, range};
use crate::table::{Cell, ColumnRole, Table};
use basrelief_report::number::{round_number, round_step};

/// Positions are whole numbers from 0 to this: finer than a pixel, short in a file.
pub(super) const WHOLE: u32 = 10_000;
/// Share of the scale that is left free at either end.
const PADDING: f64 = 0.03;
/// Parts that a linear scale is divided into, about.
const PARTS: f64 = 6.0;
/// Maximum number of marks of a logarithmic scale.
const MARKS: i32 = 8;

/// The scale of a column.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ColumnScale {
    /// Ticks: position and label.
    pub(super) ticks: Vec<(u32, String)>,
    /// Position of each row, up to [`WHOLE`]; `None` without a value.
    pub(super) at: Vec<Option<u32>>,
    /// Lowest and highest value in words.
    pub(super) ends: [String; 2],
    /// True if equal ratios have equal lengths.
    pub(super) logarithmic: bool,
    /// Number of values at equal distances; `None` if distances follow from the values.
    pub(super) levels: Option<usize>,
}

impl ColumnScale {
    /// Returns the scale of a column, or `None` if all rows have the same value. Words, and few values of an axis, have equal distances.
    pub(super) fn of(table: &Table, column: usize) -> Option<Self> {
        let cells: Vec<&Cell> = table.rows.iter().filter_map(|row| row.cells.get(column)).collect();
        let levels = || Some(ColumnLevels::of(table, column));
        let words = cells.iter().any(|cell| matches!(cell, Cell::Text(_)));
        let few = levels().filter(|levels| levels.single && table.columns[column].role == ColumnRole::Axis || words);
        match few {
            Some(levels) => Self::equal(&levels),
            None => {
                let values: Vec<_> = cells.iter().map(|cell| cell.number()).collect();
                Self::numeric(&values, &table.columns[column].unit)
            }
        }
    }

    fn equal(levels: &ColumnLevels) -> Option<Self> {
        let count = levels.labels.len();
        let position = |level: usize| part((level as f64 + 0.5) / count as f64);
        let [first, .., last] = levels.labels.as_slice() else { return None };
        Some(Self {
            ticks: levels.labels.iter().enumerate().map(|(level, label)| (position(level), label.clone())).collect(),
            at: levels.of_row.iter().map(|level| level.map(position)).collect(),
            ends: [first.clone(), last.clone()],
            logarithmic: false,
            levels: Some(count),
        })
    }

    fn numeric(values: &[Option<f64>], unit: &str) -> Option<Self> {
        let (low, high) = range(values.iter().flatten().copied())?;
        if low >= high {
            return None;
        }
        let logarithmic = logarithmic((low, high));
        let along = |x: f64| if logarithmic { libm::log10(x) } else { x };
        // Halves: a distance of two large numbers must not overflow.
        let (start, end) = (along(low) / 2.0, along(high) / 2.0);
        let position = |x: f64| part(PADDING + (1.0 - 2.0 * PADDING) * (along(x) / 2.0 - start) / (end - start));
        let ticks = if logarithmic { logarithmic_ticks(low, high) } else { linear_ticks(low, high) };
        Some(Self {
            ticks: ticks.into_iter().map(|(x, label)| (position(x), label)).collect(),
            at: values.iter().map(|value| value.map(position)).collect(),
            ends: [low, high].map(|x| rounded(x, unit)),
            logarithmic,
            levels: None,
        })
    }
}

fn part(share: f64) -> u32 {
    libm::round(share * f64::from(WHOLE)) as u32
}

/// Round numbers from low to high, at distances of 1, 2 or 5 times a power of ten.
fn linear_ticks(low: f64, high: f64) -> Vec<(f64, String)> {
    let (digit, exponent) = round_step(high / PARTS - low / PARTS);
    let step = round_number(digit, exponent);
    let (unit, suffix) = unit(low.abs().max(high.abs()));
    let decimals = (f64::from(-exponent) + libm::log10(unit)).clamp(0.0, 17.0) as usize;
    let first = libm::ceil(low / step);
    let values = (0..=2 * PARTS as u32).map(|k| first + f64::from(k)).map(|k| k * step).take_while(|x| *x <= high);
    values.map(|x| (x, format_number(x / unit, decimals, suffix))).collect()
}

fn format_number(x: f64, decimals: usize, suffix: &str) -> String {
    // Zero has no sign.
    let x = if x == 0.0 { 0.0 } else { x };
    let long = x.abs() >= 1e6 || decimals > 6;
    if long { format!("{x:.3e}") } else { format!("{x:.decimals$}{suffix}") }
}

/// Returns powers of ten; if these are few, also their doubles and fivefolds.
fn logarithmic_ticks(low: f64, high: f64) -> Vec<(f64, String)> {
    let ends = [low, high].map(|x| libm::floor(libm::log10(x)) as i32);
    let digits: &[u32] = if ends[1] - ends[0] <= 2 { &[1, 2, 5] } else { &[1] };
    let every = (ends[1] - ends[0]) / MARKS + 1;
    let powers = (ends[0]..=ends[1]).step_by(every as usize);
    let values = powers.flat_map(|exponent| digits.iter().map(move |digit| round_number(*digit, exponent)));
    values.filter(|x| (low..=high).contains(x)).map(|x| (x, short(x))).collect()
}

/// A round number, short.
fn short(x: f64) -> String {
    let (unit, suffix) = unit(x);
    let x = x / unit;
    if (1e-3..1e4).contains(&x) { format!("{x}{suffix}") } else { format!("{x:e}{suffix}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(values: &[f64]) -> Vec<String> {
        let scale = ColumnScale::numeric(&values.iter().map(|x| Some(*x)).collect::<Vec<_>>(), "").unwrap();
        scale.ticks.into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn marks_are_round_and_short() {
        assert_eq!(labels(&[16.63, 33.06]), ["20", "25", "30"]);
        assert_eq!(labels(&[0.0, 0.7]), ["0.0", "0.2", "0.4", "0.6"]);
        assert_eq!(labels(&[437_929.0, 3_428_606.0]), ["0.5 M", "1.0 M", "1.5 M", "2.0 M", "2.5 M", "3.0 M"]);
        assert_eq!(labels(&[237_929.0, 3_428_606.0]), ["500 k", "1 M", "2 M"]);
        assert_eq!(labels(&[-3.0, 3.0]), ["-3", "-2", "-1", "0", "1", "2", "3"]);
        assert_eq!(labels(&[120_000.0, 190_000.0]), ["120 k", "140 k", "160 k", "180 k"]);
        assert_eq!(labels(&[700.0, 90_000.0]), ["1000", "2000", "5000", "10 k", "20 k", "50 k"]);
        assert_eq!(labels(&[1.0, 1e6]), ["1", "10", "100", "1000", "10 k", "100 k", "1 M"]);
        assert_eq!(labels(&[1e-9, 2e-9]), ["1.000e-9", "1.200e-9", "1.400e-9", "1.600e-9", "1.800e-9", "2.000e-9"]);
    }

    proptest! {
        #[test]
        fn any_numbers_have_a_scale(values in prop::collection::vec(prop::num::f64::ANY, 2..6)) {
            let known: Vec<Option<f64>> = values.iter().map(|x| Some(*x).filter(|x| x.is_finite())).collect();
            if let Some(scale) = ColumnScale::numeric(&known, "") {
                prop_assert!(scale.at.iter().flatten().all(|at| *at <= WHOLE), "{:?}", scale);
                prop_assert!(scale.ticks.iter().all(|(at, label)| *at <= WHOLE && label.len() <= 12), "{:?}", scale);
                prop_assert!(scale.ticks.len() <= 13 && scale.ticks.is_sorted_by(|a, b| a.0 <= b.0), "{:?}", scale);
            }
        }
    }

    #[test]
    fn constant_column_has_no_scale() {
        assert_eq!(ColumnScale::numeric(&[Some(1.0), None, Some(1.0)], ""), None);
        assert_eq!(ColumnScale::numeric(&[], ""), None);
    }
}
