//! Tables: those of the terminal, and those with drawings in their cells.

use super::markup::{Html, el, el_text, text};
use crate::text::table::{Align, Table};

/// A table of the terminal, with every column; nothing where it has no rows.
pub(super) fn html(caption: &str, table: &Table) -> Html {
    let columns: Vec<(&str, Align)> = table.columns().collect();
    let rows = table.rows().iter().map(|row| row.iter().map(text).collect());
    with_cells(caption, &columns, rows.collect())
}

/// A table of these titles; the first cell of a row is its heading.
pub fn with_cells(caption: &str, columns: &[(&str, Align)], rows: Vec<Vec<Html>>) -> Html {
    if rows.is_empty() {
        return Html::default();
    }
    let class = |align| if align == Align::Right { "right" } else { "left" };
    let titles = columns.iter().map(|(title, align)| match *title {
        "" => el("td", &[], []),
        title => el("th", &[("scope", "col"), ("class", class(*align))], [text(title)]),
    });
    let body = rows.into_iter().map(|row| {
        let cells = row.into_iter().zip(columns).enumerate().map(|(at, (cell, (_, align)))| match at {
            0 => el("th", &[("scope", "row"), ("class", class(*align))], [cell]),
            _ => el("td", &[("class", class(*align))], [cell]),
        });
        el("tr", &[], cells)
    });
    let parts = [el_text("caption", "", caption), el("thead", &[], [el("tr", &[], titles)]), el("tbody", &[], body)];
    el("div", &[("class", "wide")], [el("table", &[], parts)])
}
