//! Export of a table as a Parquet file: the columns of the CSV with types, compressed with zstd. Key-value
//! metadata `columns` has the unit, role and meaning of each column, as JSON.

use crate::table::Table;
use crate::typed::{ColumnValues, columns};
use crate::write::about_columns;
use ::parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use ::parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use ::parquet::errors::Result;
use ::parquet::file::metadata::KeyValue;
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use ::parquet::schema::types::{Type, TypePtr};
use std::io;
use std::sync::Arc;

/// Returns the table as Parquet. Equal tables give equal bytes.
///
/// # Errors
/// A table that the library rejects.
pub fn parquet(table: &Table) -> io::Result<Vec<u8>> {
    file(table).map_err(io::Error::other)
}

fn file(table: &Table) -> Result<Vec<u8>> {
    let columns = columns(table);
    let fields = columns.iter().map(|(name, values)| field(name, values)).collect::<Result<_>>()?;
    let schema = Type::group_type_builder("points").with_fields(fields).build()?;
    let about = serde_json::to_string(&about_columns(table)).unwrap_or_default();
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_created_by("basrelief".into())
        .set_key_value_metadata(Some(vec![KeyValue::new("columns".into(), about)]))
        .build();
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, Arc::new(schema), Arc::new(properties))?;
    let mut rows = writer.next_row_group()?;
    for (_, values) in &columns {
        let Some(column) = rows.next_column()? else { break };
        match values {
            ColumnValues::Whole(values) => write::<Int64Type, _>(column, values, |n| *n)?,
            ColumnValues::Number(values) => write::<DoubleType, _>(column, values, |x| *x)?,
            ColumnValues::Text(values) => write::<ByteArrayType, _>(column, values, |text| ByteArray::from(text.as_str()))?,
        }
    }
    rows.close()?;
    writer.close()?;
    Ok(bytes)
}

fn field(name: &str, values: &ColumnValues) -> Result<TypePtr> {
    let (physical, logical) = match values {
        ColumnValues::Whole(_) => (Physical::INT64, None),
        ColumnValues::Number(_) => (Physical::DOUBLE, None),
        ColumnValues::Text(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
    };
    let field = Type::primitive_type_builder(name, physical).with_repetition(Repetition::OPTIONAL);
    Ok(Arc::new(field.with_logical_type(logical).build()?))
}

/// Writes a column: its known values, and for each row whether the value is known.
fn write<T: DataType, V>(mut column: SerializedColumnWriter<'_>, values: &[Option<V>], of: impl Fn(&V) -> T::T) -> Result<()> {
    let known: Vec<T::T> = values.iter().flatten().map(of).collect();
    let levels: Vec<i16> = values.iter().map(|value| value.is_some().into()).collect();
    column.typed::<T>().write_batch(&known, Some(&levels), None)?;
    column.close()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::typed::samples::every_kind;
    use ::parquet::file::reader::{FileReader, SerializedFileReader};
    use ::parquet::record::Field;

    #[test]
    fn written_table_reads_back() {
        let table = every_kind();
        let bytes = parquet(&table).unwrap();
        assert_eq!(bytes, parquet(&table).unwrap(), "the same bytes");
        let reader = SerializedFileReader::new(bytes::Bytes::from(bytes)).unwrap();
        let expected = columns(&table);
        for (at, row) in reader.get_row_iter(None).unwrap().enumerate() {
            let row = row.unwrap();
            assert_eq!(row.len(), expected.len());
            for ((name, field), (expected_name, values)) in row.get_column_iter().zip(&expected) {
                let expected = match values {
                    ColumnValues::Whole(values) => values[at].map_or(Field::Null, Field::Long),
                    ColumnValues::Number(values) => values[at].map_or(Field::Null, Field::Double),
                    ColumnValues::Text(values) => values[at].clone().map_or(Field::Null, Field::Str),
                };
                assert_eq!((name, field), (expected_name, &expected), "row {at}");
            }
        }
        let metadata = reader.metadata().file_metadata();
        assert_eq!(metadata.num_rows(), table.rows.len() as i64);
        let about = metadata.key_value_metadata().unwrap().iter().find(|pair| pair.key == "columns").unwrap();
        assert!(about.value.as_ref().unwrap().contains("\"unit\":\"cycles\""), "{about:?}");
    }
}
