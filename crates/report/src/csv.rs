//! The figures of a report as CSV, one per line, for pandas, R or a spreadsheet.
//!
//! Columns: `table,name,field,key,value`.
//!
//! | table | name | field | key |
//! |---|---|---|---|
//! | `run` | `version`, `machine`, `input`, `outcome` ... | `value` | |
//! | `cycles` | | `total`, `frames`, `write_tail` | frame, from 0 |
//! | `config` | parameter, as in `--set` | `value` | |
//! | `units` | unit | `steps`, `tokens`, `busy`, `starved`, `blocked`, `memory`, `done` | FIFO or client waited for |
//! | `fifos` | FIFO | `depth`, `tokens`, `high_water`, `mean_occupancy`, `full_cycles`, `histogram` | slots held |
//! | `memories` | memory | `reads` ... `latency_95`, `latency` | client |
//! | `channels` | memory | `row_hits` ... `queued` | channel, from 0 |
//! | `caches` | cache | `lookups`, `hits`, `misses`, `merged` | |
//! | `costs` | `pixels`, `non_pixel`, `unattributed`, `frame` | `cycles`, `busy`, `starved`, `memory`, `blocked` | of `frame` its number |
//! | `objects` | object; `others` | `polygons`, `fragments`, `cycles` ... `blocked`; of `others` `count` | |
//! | `polygons` | frame`.`polygon; `others` | `object`, `fragments`, `cycles` ... `blocked`; of `others` `count` | |
//! | `figures` | figure | `value` | place in a list, from 0 |
//! | `quality` | | `psnr_db`, `ssim`, `flip`; of the final image `mean_difference`, `largest_difference` | frame, from 0; empty: the final image; `min`, `max`, `mean`: of all pictures |
//! | `image` | file | `sha256` | |
//! | `derived` | figure | `value` | unit of measure |
//!
//! `pandas.read_csv(f).query("table == 'units'").pivot_table("value", "name", "field")` needs `value` made numeric
//! first, since it holds words too. Lines end in a line feed; quoting is that of RFC 4180.

use crate::long_table;
use crate::model::{Figure, Report};

/// The whole report but its host part, header first.
pub fn to_csv(report: &Report) -> String {
    let rows = long_table::rows(report).into_iter();
    let cells = rows.map(|row| [row.table.to_owned(), row.name, row.field.to_owned(), row.key, unformatted(&row.value)]);
    csv_text(["table", "name", "field", "key", "value"], cells)
}

/// A header and rows as CSV text. Memory takes every write, so the text is complete.
pub(crate) fn csv_text<const N: usize>(header: [&str; N], rows: impl IntoIterator<Item = [String; N]>) -> String {
    let mut writer = csv::Writer::from_writer(vec![]);
    let mut is_written = writer.write_record(header).is_ok();
    for row in rows {
        is_written &= writer.write_record(row.map(no_formula)).is_ok();
    }
    debug_assert!(is_written);
    writer.into_inner().ok().and_then(|bytes| String::from_utf8(bytes).ok()).unwrap_or_default()
}

/// Puts an apostrophe before a cell that a spreadsheet would execute as a formula: it begins with `=`, `+`, `-` or `@`, and does not
/// consist of numbers.
pub fn no_formula(cell: String) -> String {
    let is_formula = cell.starts_with(['=', '+', '-', '@']) && cell.split(' ').any(|word| word.parse::<f64>().is_err());
    if is_formula { format!("'{cell}") } else { cell }
}

fn unformatted(value: &Figure) -> String {
    match value {
        Figure::Count(n) => n.to_string(),
        Figure::Real(x) => x.to_string(),
        Figure::Text(text) => text.clone(),
        Figure::List(list) => list.iter().map(unformatted).collect::<Vec<_>>().join(" "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples;

    fn parse(text: &str) -> Vec<Vec<String>> {
        let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(text.as_bytes());
        reader.records().map(|row| row.unwrap().iter().map(str::to_owned).collect()).collect()
    }

    #[test]
    fn formulas_become_text() {
        for (cell, written) in [
            ("=1+1", "'=1+1"),
            ("@a", "'@a"),
            ("-a", "'-a"),
            ("+a b", "'+a b"),
            ("-1.5", "-1.5"),
            ("-1 2", "-1 2"),
            ("a=b", "a=b"),
        ] {
            assert_eq!(no_formula(cell.into()), written);
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
