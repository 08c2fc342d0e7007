//! Points on the front, one by one; and those that failed.

use super::data::SweepView;
use super::labels;
use crate::table::PointState;
use basrelief_report::html::markup::{Html, details, el, el_text, text};
use basrelief_report::html::{Align, with_cells};
use basrelief_report::number::thousands;
use std::collections::BTreeMap;

/// Maximum number of rows of the table.
const MOST: usize = 200;
const OPEN: usize = 16;
/// Maximum number of listed reasons.
const MOST_REASONS: usize = 20;

/// The front as a table, best by the first objective first.
pub(super) fn front(sweep: &SweepView<'_>) -> Html {
    let told = sweep.summary_columns();
    let Some((first, goal)) = sweep.table.objectives().next() else { return Html::default() };
    let cost = |row: usize| sweep.table.rows[row].cells.get(first).and_then(|cell| Some(goal.cost(cell.number()?)));
    let mut rows = sweep.front.clone();
    let by_cost = |a: usize, b: usize| cost(a).unwrap_or(f64::MAX).total_cmp(&cost(b).unwrap_or(f64::MAX));
    rows.sort_by(|&a, &b| sweep.inputs[a].cmp(&sweep.inputs[b]).then(by_cost(a, b)));
    rows.truncate(MOST);
    let pictures = rows.iter().any(|&row| sweep.table.rows[row].picture.is_some());
    let headers: Vec<String> = told.iter().map(|&at| sweep.header(at)).collect();
    let ties = sweep.ties(None) > 0;
    let own = [(true, ("point", Align::Left)), (ties, ("ties", Align::Right)), (pictures, ("image", Align::Left))];
    let own = own.into_iter().filter(|(is_shown, _)| *is_shown).map(|(_, column)| column);
    let columns: Vec<(&str, Align)> = own.chain(headers.iter().map(|name| (name.as_str(), Align::Right))).collect();
    let table = |rows: &[usize], before: usize, caption: &str| {
        let numbered = rows.iter().enumerate().map(|(at, &row)| (before + at + 1, row));
        with_cells(caption, &columns, numbered.map(|(number, row)| cells(sweep, number, row, &told, [ties, pictures])).collect())
    };
    let (first, others) = rows.split_at(rows.len().min(OPEN));
    let (all, shown) = (sweep.front.len(), rows.len());
    let caption = if first.len() == all {
        "All Pareto-optimal points".into()
    } else {
        format!("{} of {} Pareto-optimal points", first.len(), thousands(all as u64))
    };
    let left = if shown < all {
        format!("{} of {} more", others.len(), thousands((all - first.len()) as u64))
    } else {
        format!("{} more", others.len())
    };
    let tables = [table(first, 0, &caption), details(&left, table(others, first.len(), "Other Pareto-optimal points"))];
    let about = "Ties equal their point in every objective and have no smaller area.";
    let about = if ties { el_text("p", "quiet", about) } else { Html::default() };
    if rows.is_empty() { Html::default() } else { el("div", &[("id", "chosen")], [about].into_iter().chain(tables)) }
}

/// Cells of a point with its number in the table. Its hash is a tooltip.
fn cells(sweep: &SweepView<'_>, number: usize, row: usize, told: &[usize], [ties, pictures]: [bool; 2]) -> Vec<Html> {
    let of = &sweep.table.rows[row];
    // The script shows the point that is named.
    let button = el("button", &[("type", "button"), ("title", &of.id), ("data-id", &of.id)], [text(number.to_string())]);
    let is_default = if sweep.is_default(row) { text(" default") } else { Html::default() };
    let name = [button, is_default].into_iter().collect();
    let picture = of.picture.as_deref().map_or_else(Html::default, |path| {
        el("img", &[("src", path), ("alt", ""), ("loading", "lazy"), ("class", "thumbnail")], [])
    });
    let values = told
        .iter()
        .map(|&at| text(of.cells.get(at).map_or(String::new(), |cell| labels::cell(cell, &sweep.table.columns[at].unit))));
    let ties = ties.then(|| text(thousands(sweep.ties(Some(row)) as u64)));
    [name].into_iter().chain(ties).chain(pictures.then_some(picture)).chain(values).collect()
}

/// Returns the reasons of failed points, the most frequent one first.
pub(super) fn failures(sweep: &SweepView<'_>) -> Html {
    let mut reasons: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for row in &sweep.table.rows {
        if let PointState::Failed(reason) = &row.state {
            reasons.entry(reason).or_default().push(&row.id);
        }
    }
    let mut reasons: Vec<(&str, Vec<&str>)> = reasons.into_iter().collect();
    reasons.sort_by_key(|(_, ids)| std::cmp::Reverse(ids.len()));
    let count = reasons.len();
    let row = |(reason, ids): (&str, Vec<&str>)| {
        vec![text(thousands(ids.len() as u64)), text(reason), details("hash", el_text("code", "", ids[0]))]
    };
    let columns = [("points", Align::Right), ("reason", Align::Left), ("first point", Align::Left)];
    let caption =
        if count > MOST_REASONS { format!("The {MOST_REASONS} most frequent of {count} reasons") } else { "All reasons".into() };
    with_cells(&caption, &columns, reasons.into_iter().take(MOST_REASONS).map(row).collect())
}
