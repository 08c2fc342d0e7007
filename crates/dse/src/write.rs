//! Export of a table as CSV and as JSON lines, for pandas, R, jq or a spreadsheet.
//!
//! Both have the same columns: `id`, `state` (`ok`, `failed`, `pending`), `reason` of a failure, then the columns of the table under
//! [`Column::header`](crate::Column::header): name and unit. Numbers are the shortest that read back to the same value. Unknown
//! values are an empty cell in CSV, and `null` in JSON.

use crate::table::{Cell, OWN, PICTURE, Row, Table};
#[cfg(any(feature = "parquet", feature = "sqlite"))]
use crate::{Column, ColumnRole, ObjectiveDirection};
use basrelief_report::no_formula;
use serde::Serializer;
use serde_json::Value;
use std::io::{self, Write};

/// The table as CSV: a header, then a line per row. Lines end in a line feed; quoting is that of RFC 4180.
///
/// # Errors
/// Those of `out`.
pub fn csv(table: &Table, out: impl Write) -> io::Result<()> {
    let mut out = csv::Writer::from_writer(out);
    let headers = table.columns.iter().map(|column| column.header());
    out.write_record(OWN.map(str::to_owned).into_iter().chain(headers).map(no_formula)).map_err(io_error)?;
    for Row { id, state, cells, .. } in &table.rows {
        let own = [id, state.word(), state.reason()].map(str::to_owned);
        out.write_record(own.into_iter().chain(cells.iter().map(Cell::to_string)).map(no_formula)).map_err(io_error)?;
    }
    out.flush()
}

/// Converts the error. Its kind distinguishes a full disk from other causes.
fn io_error(error: csv::Error) -> io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        other => io::Error::other(format!("{other:?}")),
    }
}

/// Writes the table as JSON lines: an object per row, with the columns of the CSV and `picture`. Numbers that are not finite are `null`.
///
/// # Errors
/// Those of `out`.
pub fn json_lines(table: &Table, mut out: impl Write) -> io::Result<()> {
    let headers: Vec<String> = table.columns.iter().map(|column| column.header()).collect();
    for Row { id, state, cells, picture } in &table.rows {
        let own = OWN.into_iter().zip([id, state.word(), state.reason()].map(Value::from));
        let cells = headers.iter().map(String::as_str).zip(cells.iter().map(value));
        let picture = (PICTURE, picture.as_deref().into());
        // A `Value` is no choice, because the order of its keys depends on features that other crates may enable.
        serde_json::Serializer::new(&mut out).collect_map(own.chain(cells).chain([picture]))?;
        out.write_all(b"\n")?;
    }
    out.flush()
}

/// Description of a column, for formats with such a field.
#[cfg(any(feature = "parquet", feature = "sqlite"))]
#[derive(Debug, serde::Serialize)]
pub(crate) struct AboutColumn {
    /// Name in the written file.
    pub(crate) name: String,
    pub(crate) unit: String,
    /// `min` or `max` for an objective, `axis` for an axis, otherwise `figure`.
    pub(crate) role: &'static str,
    pub(crate) what: String,
}

/// The columns of a table, but for those that every written table has.
#[cfg(any(feature = "parquet", feature = "sqlite"))]
pub(crate) fn about_columns(table: &Table) -> Vec<AboutColumn> {
    let role = |role: ColumnRole| match role {
        ColumnRole::Objective(ObjectiveDirection::Min) => "min",
        ColumnRole::Objective(ObjectiveDirection::Max) => "max",
        ColumnRole::Axis => "axis",
        ColumnRole::Figure => "figure",
    };
    let about = |c: &Column| AboutColumn { name: c.header(), unit: c.unit.clone(), role: role(c.role), what: c.what.clone() };
    table.columns.iter().map(about).collect()
}

/// A cell as JSON.
pub(crate) fn value(cell: &Cell) -> Value {
    match cell {
        Cell::Number(x) => (*x).into(),
        Cell::Whole(n) => (*n).into(),
        Cell::Text(text) => text.as_str().into(),
        Cell::Missing => Value::Null,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::PointState;
    #[cfg(not(any(feature = "parquet", feature = "sqlite")))]
    use crate::{Column, ColumnRole, ObjectiveDirection};
    use proptest::prelude::*;

    fn column(name: &str, unit: &str) -> Column {
        Column { name: name.into(), unit: unit.into(), role: ColumnRole::Objective(ObjectiveDirection::Min), what: String::new() }
    }

    fn table(cells: Vec<Vec<Cell>>) -> Table {
        let row = |cells| Row { id: "f00".into(), state: PointState::Ok, cells, picture: Some("points/f00/image.png".into()) };
        let columns = vec![column("cycles", "cycles"), column("mode", "")];
        Table { columns, rows: cells.into_iter().map(row).collect(), ..Table::default() }
    }

    fn text(write: impl Fn(&Table, &mut Vec<u8>) -> io::Result<()>, table: &Table) -> String {
        let mut bytes = vec![];
        write(table, &mut bytes).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn columns_have_units_and_failures_their_reason() {
        let mut table = table(vec![vec![Cell::Whole(7), Cell::Text("a, \"b\"\n".into())], vec![Cell::Missing, Cell::Missing]]);
        table.rows[1].state = PointState::Failed("deadlock".into());
        table.rows[1].picture = None;
        let expected = "id,state,reason,cycles [cycles],mode\nf00,ok,,7,\"a, \"\"b\"\"\n\"\nf00,failed,deadlock,,\n";
        assert_eq!(text(|t, o| csv(t, o), &table), expected);
        let expected = concat!(
            r#"{"id":"f00","state":"ok","reason":"","cycles [cycles]":7,"mode":"a, \"b\"\n","picture":"points/f00/image.png"}"#,
            "\n",
            r#"{"id":"f00","state":"failed","reason":"deadlock","cycles [cycles]":null,"mode":null,"picture":null}"#,
            "\n"
        );
        assert_eq!(text(|t, o| json_lines(t, o), &table), expected);
    }

    proptest! {
        #[test]
        fn written_table_reads_back_exactly(x in any::<f64>(), n in any::<u64>(), word in "[a-c,\"\r\n é]{0,6}") {
            let table = table(vec![vec![Cell::Number(x), Cell::Text(word.clone())], vec![Cell::Whole(n), Cell::Missing]]);
            let written = text(|t, o| csv(t, o), &table);
            let rows: Vec<csv::StringRecord> = csv::Reader::from_reader(written.as_bytes()).records().map(Result::unwrap).collect();
            prop_assert_eq!(&rows[0][4], &word);
            let same = |read: f64| read.to_bits() == x.to_bits() || read.is_nan() && x.is_nan();
            prop_assert!(same(rows[0][3].parse().unwrap()), "{}", &rows[0][3]);
            prop_assert_eq!(rows[1][3].parse::<u64>().unwrap(), n);
            let written = text(|t, o| json_lines(t, o), &table);
            let rows: Vec<Value> = written.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
            prop_assert_eq!(&rows[0]["mode"], &Value::from(word));
            let read = rows[0]["cycles [cycles]"].as_f64();
            prop_assert!(read.map_or(!x.is_finite(), same), "{:?}", read);
            prop_assert_eq!(rows[1]["cycles [cycles]"].as_u64(), Some(n));
        }
    }

    #[test]
    fn a_full_disk_is_an_error() {
        struct Full;
        impl Write for Full {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                Err(io::ErrorKind::StorageFull.into())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let table = table(vec![vec![Cell::Missing, Cell::Missing]]);
        assert_eq!(csv(&table, Full).unwrap_err().kind(), io::ErrorKind::StorageFull);
        assert_eq!(json_lines(&table, Full).unwrap_err().kind(), io::ErrorKind::StorageFull);
    }
}
