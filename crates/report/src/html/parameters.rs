//! Section with the configuration and the provenance of each value.

use super::markup::{Html, details, el, el_text, text};
use super::table::with_cells;
use crate::text::table::Align::{Left, Right};

/// A parameter of the machine.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ParameterRow {
    /// Key of `--set KEY=VALUE`.
    pub key: String,
    /// Value in this run.
    pub value: String,
    /// Default of the machine.
    pub default: String,
    /// Unit of measure; empty for a switch or a choice.
    pub unit: String,
    /// Meaning.
    pub about: String,
    /// Provenance of the default: stated, derived or assumed.
    pub provenance: String,
    /// Source of the default, in words.
    pub source: String,
}

/// Returns the table of changed parameters, and a collapsed table of the others.
pub(super) fn parameters(rows: &[ParameterRow]) -> Html {
    if rows.is_empty() {
        return Html::default();
    }
    let (same, other): (Vec<&ParameterRow>, Vec<&ParameterRow>) = rows.iter().partition(|row| row.value == row.default);
    let none = || el_text("p", "", format!("All {} parameters have their default values.", rows.len()));
    let first = if other.is_empty() { none() } else { table("Different from the defaults", &other) };
    let rest = details(&format!("{} parameters with their default values", same.len()), table("As by default", &same));
    [first, rest].into_iter().collect()
}

fn table(caption: &str, rows: &[&ParameterRow]) -> Html {
    let changed = rows.iter().any(|row| row.value != row.default);
    let columns =
        [("parameter", Left), ("value", Right), ("unit", Left), ("default", Right), ("default from", Left), ("about", Left)];
    let cells = |row: &&ParameterRow| {
        let from = [el_text("b", "", &row.provenance), text(format!(": {}", row.source))].into_iter().collect();
        let key = el_text("code", "", &row.key);
        vec![key, text(&row.value), text(&row.unit), text(&row.default), from, text(&row.about)]
    };
    // If every value is the default, one column suffices.
    let kept = |at: usize| changed || at != 3;
    let columns: Vec<_> = columns.into_iter().enumerate().filter(|(at, _)| kept(*at)).map(|(_, column)| column).collect();
    let row = |row| cells(row).into_iter().enumerate().filter(|(at, _)| kept(*at)).map(|(_, cell)| cell).collect();
    el("div", &[("class", "parameters")], [with_cells(caption, &columns, rows.iter().map(row).collect())])
}
