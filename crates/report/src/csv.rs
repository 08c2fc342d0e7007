//! The figures of a report as CSV, one per line, for pandas, R or a spreadsheet.
//!
//! Columns: `table,name,field,key,value`.
//!
//! | table | name | field | key |
//! |---|---|---|---|
//! | `run` | `version`, `machine`, `input`, `outcome` ... | `value` | |
//! | `cycles` | | `total`, `frames`, `drain` | frame, from 0 |
//! | `config` | parameter, as in `--set` | `value` | |
//! | `units` | unit | `steps`, `tokens`, `busy`, `starved`, `blocked`, `memory`, `done` | FIFO or client waited for |
//! | `fifos` | FIFO | `depth`, `tokens`, `high_water`, `mean_occupancy`, `full_cycles`, `histogram` | slots held |
//! | `memories` | memory | `reads` ... `queue_wait`, `latency` | client |
//! | `channels` | memory | `row_hits` ... `queued` | channel, from 0 |
//! | `caches` | cache | `look_ups`, `hits`, `misses`, `merged` | |
//! | `costs` | `pixels`, `elsewhere`, `nobody`, `frame` | `cycles`, `busy`, `starved`, `memory`, `blocked` | of `frame` its number |
//! | `objects` | object; `others` | `polygons`, `fragments`, `cycles` ... `blocked`; of `others` `count` | |
//! | `polygons` | frame`.`polygon; `others` | `object`, `fragments`, `cycles` ... `blocked`; of `others` `count` | |
//! | `figures` | figure | `value` | place in a list, from 0 |
//! | `quality` | | `psnr_db`, `ssim`, `flip`; of the final picture `mean_difference`, `largest_difference` | frame, from 0; empty: the final picture |
//! | `image` | file | `sha256` | |
//! | `derived` | figure | `value` | unit of measure |
//!
//! `pandas.read_csv(f).query("table == 'units'").pivot_table("value", "name", "field")` needs `value` made numeric
//! first, since it holds words too. Lines end in a line feed; quoting is that of RFC 4180.

use crate::model::{Figure, Report};
use crate::tidy;
use std::borrow::Cow;

/// The whole report but its host part, header first.
pub fn to_csv(report: &Report) -> String {
    let mut text = String::from("table,name,field,key,value\n");
    for row in tidy::rows(report) {
        let value = plain(&row.value);
        let cells = [row.table, &row.name, row.field, &row.key, &value].map(quoted);
        text += &(cells.join(",") + "\n");
    }
    text
}

fn plain(value: &Figure) -> String {
    match value {
        Figure::Count(n) => n.to_string(),
        Figure::Real(x) => x.to_string(),
        Figure::Text(text) => text.clone(),
        Figure::List(list) => list.iter().map(plain).collect::<Vec<_>>().join(" "),
    }
}

pub(crate) fn quoted(cell: &str) -> Cow<'_, str> {
    if cell.contains([',', '"', '\n', '\r']) { format!("\"{}\"", cell.replace('"', "\"\"")).into() } else { cell.into() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples;
    use proptest::prelude::*;

    /// Reads CSV by the letter of RFC 4180.
    fn parse(text: &str) -> Vec<Vec<String>> {
        let (mut rows, mut row, mut cell, mut inside) = (vec![], vec![], String::new(), false);
        let mut chars = text.chars().peekable();
        while let Some(c) = chars.next() {
            match (c, inside) {
                ('"', true) if chars.peek() == Some(&'"') => cell.extend(chars.next()),
                ('"', _) => inside = !inside,
                (',', false) => row.push(std::mem::take(&mut cell)),
                ('\n', false) => {
                    row.push(std::mem::take(&mut cell));
                    rows.push(std::mem::take(&mut row));
                }
                _ => cell.push(c),
            }
        }
        rows
    }

    proptest! {
        #[test]
        fn cells_come_back_as_they_were(cells in proptest::collection::vec("[a-c,\"\r\n é]{0,6}", 1..5)) {
            let line = cells.iter().map(|c| quoted(c)).collect::<Vec<_>>().join(",") + "\n";
            prop_assert_eq!(parse(&line), vec![cells]);
        }
    }

    #[test]
    fn every_line_has_five_cells() {
        let mut report = samples::balanced();
        report.input.name = "a \"b\", c\nd".into();
        let rows = parse(&to_csv(&report));
        assert!(rows.iter().all(|r| r.len() == 5));
        assert_eq!(rows[3], ["run", "input", "value", "", "a \"b\", c\nd"]);
        assert!(rows.contains(&["units", "replacement", "busy", "", "970000"].map(String::from).to_vec()));
        assert!(rows.contains(&["derived", "time_ms", "value", "ms", "5"].map(String::from).to_vec()));
    }
}
