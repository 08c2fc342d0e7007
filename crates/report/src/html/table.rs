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
            0 if !cell.is_empty() => el("th", &[("scope", "row"), ("class", class(*align))], [cell]),
            _ => el("td", &[("class", class(*align))], [cell]),
        });
        el("tr", &[], cells)
    });
    let parts = [el_text("caption", "", caption), el("thead", &[], [el("tr", &[], titles)]), el("tbody", &[], body)];
    // A narrow window scrolls the table. With the focus, keys scroll it.
    el("div", &[("class", "wide"), ("role", "group"), ("tabindex", "0"), ("aria-label", caption)], [el("table", &[], parts)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_takes_the_focus_and_has_no_empty_heading() {
        let columns = [("unit", Align::Left), ("share", Align::Right)];
        let row = |name: &str| vec![text(name), text("1 %")];
        let page = with_cells("Shares", &columns, vec![row("search"), row("")]).into_text();
        assert!(page.starts_with("<div class=\"wide\" role=\"group\" tabindex=\"0\" aria-label=\"Shares\">"), "{page}");
        assert!(page.contains("<th scope=\"row\" class=\"left\">search</th>"), "{page}");
        assert!(page.contains("<tr><td class=\"left\"></td>"), "{page}");
    }
}
