//! Export as a SQLite database: table `points` with the columns of the CSV, and table `columns` with the unit, role and meaning
//! of each column.

use crate::table::Table;
use crate::typed::{ColumnValues, columns};
use crate::write::about_columns;
use rusqlite::types::Value;
use rusqlite::{Connection, Result, params_from_iter};
use std::io;

/// Returns the table as a database. Equal tables give equal bytes.
///
/// # Errors
/// A table that the library rejects, for example with more than 2,000 columns.
pub fn sqlite(table: &Table) -> io::Result<Vec<u8>> {
    database(table).map_err(io::Error::other)
}

fn database(table: &Table) -> Result<Vec<u8>> {
    let mut connection = Connection::open_in_memory()?;
    let columns = columns(table);
    let declared: Vec<String> = columns.iter().map(|(name, values)| format!("{} {}", quoted(name), type_of(values))).collect();
    connection.execute_batch(&format!(
        "BEGIN; CREATE TABLE points ({}); CREATE TABLE columns (name TEXT, unit TEXT, role TEXT, what TEXT);",
        declared.join(", ")
    ))?;
    let places = vec!["?"; columns.len()].join(", ");
    let mut point = connection.prepare(&format!("INSERT INTO points VALUES ({places})"))?;
    for row in 0..table.rows.len() {
        point.execute(params_from_iter(columns.iter().map(|(_, values)| value(values, row))))?;
    }
    let mut column = connection.prepare("INSERT INTO columns VALUES (?, ?, ?, ?)")?;
    for about in about_columns(table) {
        column.execute([about.name, about.unit, about.role.into(), about.what])?;
    }
    drop((point, column));
    connection.execute_batch("COMMIT")?;
    Ok(connection.serialize("main")?.to_vec())
}

/// A name as SQL has it.
fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}

fn type_of(values: &ColumnValues) -> &'static str {
    match values {
        ColumnValues::Whole(_) => "INTEGER",
        ColumnValues::Number(_) => "REAL",
        ColumnValues::Text(_) => "TEXT",
    }
}

/// The value of a row. (SQLite has no "not a number": it becomes NULL.)
fn value(values: &ColumnValues, row: usize) -> Value {
    match values {
        ColumnValues::Whole(values) => values[row].into(),
        ColumnValues::Number(values) => values[row].into(),
        ColumnValues::Text(values) => values[row].clone().into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::typed::samples::every_kind;
    use std::io::Cursor;

    #[test]
    fn written_table_reads_back() {
        let table = every_kind();
        let bytes = sqlite(&table).unwrap();
        assert_eq!(bytes, sqlite(&table).unwrap(), "the same bytes");
        let mut connection = Connection::open_in_memory().unwrap();
        connection.deserialize_read_exact("main", Cursor::new(&bytes), bytes.len(), true).unwrap();
        let expected = columns(&table);
        for (name, values) in &expected {
            let mut query = connection.prepare(&format!("SELECT {} FROM points ORDER BY rowid", quoted(name))).unwrap();
            let found: Vec<Value> = query.query_map([], |row| row.get(0)).unwrap().map(Result::unwrap).collect();
            let finite = |value: Value| if matches!(value, Value::Real(x) if x.is_nan()) { Value::Null } else { value };
            let expected: Vec<Value> = (0..table.rows.len()).map(|row| finite(value(values, row))).collect();
            assert_eq!(found, expected, "{name}");
        }
        let unit: String =
            connection.query_row("SELECT unit FROM columns WHERE name = 'cycles [cycles]'", [], |row| row.get(0)).unwrap();
        assert_eq!(unit, "cycles");
    }

    #[test]
    fn more_columns_than_sqlite_takes_are_an_error() {
        let mut table = every_kind();
        let column = table.columns[0].clone();
        table.columns = (0..2001).map(|n| crate::Column { name: n.to_string(), ..column.clone() }).collect();
        assert!(sqlite(&table).unwrap_err().to_string().contains("too many columns"));
    }
}
