//! A quiet table: a header, a thin line, rows. No boxes.

use super::style::{Emphasis, TextStyle};
use comfy_table::{CellAlignment, ContentArrangement, LineStyle, TableStyle};

/// Alignment of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// At its left end: words.
    Left,
    /// At its right end: numbers.
    Right,
}

#[derive(Clone, Debug)]
struct Column {
    title: String,
    align: Align,
    /// 0 stays; of the others those with the lowest are kept where the width does not hold all.
    rank: u8,
}

/// Rows under titled columns.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    columns: Vec<Column>,
    rows: Vec<Vec<String>>,
}

/// Blanks between columns: one of padding, one where other tables have a line.
const GAP: usize = 2;
const LINES: TableStyle = TableStyle::new().header_separator(LineStyle::none().fill('─').junction('─'));

impl Table {
    /// A table without rows: title, alignment and rank of each column.
    pub(crate) fn new(columns: &[(&str, Align, u8)]) -> Self {
        let columns = columns.iter().map(|&(title, align, rank)| Column { title: title.into(), align, rank }).collect();
        Self { columns, rows: vec![] }
    }

    pub(crate) fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// Titles and alignments.
    pub(crate) fn columns(&self) -> impl Iterator<Item = (&str, Align)> {
        self.columns.iter().map(|column| (column.title.as_str(), column.align))
    }

    pub(crate) fn rows(&self) -> &[Vec<String>] {
        &self.rows
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The table's lines, joined, without a line feed at the end.
    pub(crate) fn render(&self, style: TextStyle) -> String {
        let kept = self.fitting_columns(style.width);
        let mut table = comfy_table::Table::new();
        table.load_style(LINES);
        if self.width_of(&kept) > style.width {
            let width = u16::try_from(style.width.max(1)).unwrap_or(u16::MAX);
            table.set_content_arrangement(ContentArrangement::Dynamic).set_width(width);
        }
        table.set_header(kept.iter().filter_map(|&i| self.columns.get(i)).map(|c| c.title.as_str()));
        for row in &self.rows {
            table.add_row(kept.iter().map(|&i| row.get(i).map_or("", String::as_str)));
        }
        for (at, column) in kept.iter().filter_map(|&i| self.columns.get(i)).enumerate() {
            if let Some(set) = table.column_mut(at) {
                set.set_padding((0, u16::from(at + 1 < kept.len())));
                set.set_cell_alignment(if column.align == Align::Right { CellAlignment::Right } else { CellAlignment::Left });
            }
        }
        let emphasis = |line: (usize, &str)| match line {
            (0, text) => style.paint(Emphasis::Bold, text),
            (1, text) => style.paint(Emphasis::Dim, text),
            (_, text) => text.into(),
        };
        let text = table.trim_fmt();
        text.lines().map(str::trim_end).enumerate().map(emphasis).collect::<Vec<String>>().join("\n")
    }

    /// Numbers of the columns that must stay, and of the others, lowest rank first, all that fit beside them.
    fn fitting_columns(&self, width: usize) -> Vec<usize> {
        let mut by_rank: Vec<(u8, usize)> = self.columns.iter().enumerate().map(|(i, c)| (c.rank, i)).collect();
        by_rank.sort_unstable();
        let mut kept: Vec<usize> = vec![];
        for (rank, i) in by_rank {
            kept.push(i);
            if rank > 0 && self.width_of(&kept) > width {
                kept.pop();
            }
        }
        kept.sort_unstable();
        kept
    }

    fn width_of(&self, kept: &[usize]) -> usize {
        let cells = |i: usize| self.rows.iter().filter_map(move |r| r.get(i)).map(|c| c.chars().count()).max().unwrap_or(0);
        let column = |&i: &usize| cells(i).max(self.columns.get(i).map_or(0, |c| c.title.chars().count()));
        kept.iter().map(column).sum::<usize>() + GAP * kept.len().saturating_sub(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_column_goes_first() {
        let mut table = Table::new(&[("name", Align::Left, 0), ("n", Align::Right, 1), ("remark", Align::Left, 2)]);
        table.row(["alpha".into(), "7".into(), "long".into()]);
        table.row(["b".into(), "1,000".into(), String::new()]);
        let text = |width| table.render(TextStyle { width, color: false });
        assert_eq!(text(20), "name       n  remark\n────────────────────\nalpha      7  long\nb      1,000");
        assert_eq!(text(19), "name       n\n────────────\nalpha      7\nb      1,000");
        assert_eq!(text(11), "name\n─────\nalpha\nb");
    }
}
