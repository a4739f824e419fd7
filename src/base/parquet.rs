//! Tables of typed columns with units, as Parquet files and as comma-separated values.
//!
//! The bytes depend on the table alone: the same table gives the same file.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int64Type};
use arrow_array::{Array, ArrayRef, RecordBatch};
use arrow_schema::{ArrowError, DataType, Field, Schema};
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::errors::ParquetError as LibraryError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{WriterProperties, WriterPropertiesBuilder};

use super::csv::{self, CsvError};
use super::files::{write, OutputError};
use super::provenance::GENERATOR;

/// Most rows of a row group.
const GROUP_ROWS: usize = 65_536;

/// Key of a column's unit in its metadata.
pub const UNIT_KEY: &str = "unit";

/// A named column of numbers, texts or answers.
#[derive(Debug, Clone)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Its unit, such as `N m`; empty where it has none.
    pub unit: String,
    /// Whether no entry may be missing.
    pub complete: bool,
    /// Its entries.
    pub cells: ArrayRef,
}

/// Why columns make no Parquet file.
#[derive(Debug, thiserror::Error)]
#[error("the table cannot be written as Parquet: {0}")]
pub struct ParquetError(String);

impl From<ArrowError> for ParquetError {
    fn from(error: ArrowError) -> Self {
        ParquetError(error.to_string())
    }
}

impl From<LibraryError> for ParquetError {
    fn from(error: LibraryError) -> Self {
        ParquetError(error.to_string())
    }
}

impl Column {
    /// A column of an Arrow array, whose entries may be missing.
    pub fn new(name: impl Into<String>, unit: &str, cells: impl Array + 'static) -> Self {
        Column {
            name: name.into(),
            unit: unit.to_string(),
            complete: false,
            cells: Arc::new(cells),
        }
    }

    fn field(&self) -> Field {
        let field = Field::new(&self.name, self.cells.data_type().clone(), !self.complete);
        match self.unit.as_str() {
            "" => field,
            unit => field.with_metadata(HashMap::from([(UNIT_KEY.to_string(), unit.to_string())])),
        }
    }

    /// An entry as text that reads back exactly; empty where it is missing.
    fn text(&self, row: usize) -> String {
        let cells = &self.cells;
        match cells.data_type() {
            _ if cells.is_null(row) => String::new(),
            DataType::Float64 => cells.as_primitive::<Float64Type>().value(row).to_string(),
            DataType::Int64 => cells.as_primitive::<Int64Type>().value(row).to_string(),
            _ => {
                let texts = cells.as_string_opt::<i32>();
                texts.map_or(String::new(), |texts| texts.value(row).to_string())
            }
        }
    }
}

/// The rows of some columns, which must be of one length.
///
/// # Errors
/// Columns of different lengths.
pub fn batch(columns: Vec<Column>) -> Result<RecordBatch, ArrowError> {
    let fields: Vec<Field> = columns.iter().map(Column::field).collect();
    let cells = columns.into_iter().map(|column| column.cells);
    RecordBatch::try_new(Arc::new(Schema::new(fields)), cells.collect())
}

/// The columns as comma-separated values: a header, then the rows. Numbers read back exactly; an entry
/// that is missing is empty.
///
/// # Errors
/// Never for tables in memory, as far as is known.
pub fn to_csv(columns: &[Column]) -> Result<String, CsvError> {
    let rows = columns.first().map_or(0, |column| column.cells.len());
    let header = columns.iter().map(|column| column.name.clone()).collect();
    let record = |row| columns.iter().map(|column| column.text(row)).collect();
    csv::to_text(
        std::iter::once(header)
            .chain((0..rows).map(record))
            .collect::<Vec<Vec<String>>>(),
    )
}

/// How every table is written, with what is said about it in the file's metadata.
pub fn properties(about: Vec<KeyValue>) -> WriterPropertiesBuilder {
    WriterProperties::builder()
        .set_created_by(GENERATOR.to_string())
        .set_compression(Compression::SNAPPY)
        .set_key_value_metadata(Some(about))
}

/// The file's bytes. `about` are pairs of key and text that stand in the file's metadata, in this order.
///
/// # Errors
/// Columns of different lengths.
pub fn to_bytes(columns: &[Column], about: &[(&str, String)]) -> Result<Vec<u8>, ParquetError> {
    let fields: Vec<Field> = columns.iter().map(Column::field).collect();
    let texts = || {
        about
            .iter()
            .map(|(key, text)| (key.to_string(), text.clone()))
    };
    // Readers by way of Arrow look for the texts in the schema, others in the file's metadata.
    let schema = Arc::new(Schema::new_with_metadata(fields, texts().collect()));
    let about = texts().map(|(key, text)| KeyValue::new(key, text));
    let properties = properties(about.collect())
        .set_max_row_group_size(GROUP_ROWS)
        .build();
    let mut writer = ArrowWriter::try_new(Vec::new(), Arc::clone(&schema), Some(properties))?;
    if !columns.is_empty() {
        let cells = columns.iter().map(|column| Arc::clone(&column.cells));
        writer.write(&RecordBatch::try_new(schema, cells.collect())?)?;
    }
    Ok(writer.into_inner()?)
}

/// Writes the file whole or not at all.
///
/// # Errors
/// Columns of different lengths; a file that cannot be written.
pub fn write_table(
    path: &Path,
    columns: &[Column],
    about: &[(&str, String)],
) -> Result<(), OutputError> {
    let bytes = to_bytes(columns, about).map_err(|error| OutputError::unmade(path, error))?;
    write(path, &bytes)
}

#[cfg(test)]
mod tests {
    use arrow_array::{BooleanArray, Float64Array, Int64Array, StringArray};
    use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;

    use super::*;

    fn columns() -> Vec<Column> {
        let angles = Float64Array::from(vec![Some(0.1), None, Some(-0.0)]);
        let triggers = Int64Array::from(vec![Some(3), Some(-4), None]);
        let verdicts = StringArray::from(vec![Some("proved"), None, Some("ä")]);
        let met = BooleanArray::from(vec![Some(true), Some(false), None]);
        vec![
            Column::new("angle_deg", "deg", angles),
            Column::new("triggers", "", triggers),
            Column::new("verdict", "", verdicts),
            Column::new("met", "", met),
        ]
    }

    #[test]
    fn a_table_reads_back_with_its_types_units_and_gaps() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.parquet");
        let about = [("file", "model.json".to_string())];
        write_table(&path, &columns(), &about).unwrap();
        let file = std::fs::File::open(&path).unwrap();
        let builder = ParquetRecordBatchReaderBuilder::try_new(file).unwrap();
        let schema = Arc::clone(builder.schema());
        assert_eq!(schema.field(0).metadata()[UNIT_KEY], "deg");
        assert!(schema.field(1).metadata().is_empty());
        let kept = builder.metadata().file_metadata().key_value_metadata();
        assert!(kept
            .unwrap()
            .contains(&KeyValue::new("file".to_string(), "model.json".to_string())));
        let batches: Vec<_> = builder.build().unwrap().map(Result::unwrap).collect();
        let [batch] = batches.as_slice() else {
            panic!("{} batches", batches.len());
        };
        let angles = batch.column(0).as_primitive::<Float64Type>();
        assert_eq!(angles.value(0), 0.1);
        assert!(angles.is_null(1));
        assert!(angles.value(2).is_sign_negative());
        let triggers = batch.column(1).as_primitive::<Int64Type>();
        assert_eq!((triggers.value(0), triggers.value(1)), (3, -4));
        assert!(triggers.is_null(2));
        let verdicts = batch.column(2).as_string::<i32>();
        assert_eq!((verdicts.value(0), verdicts.value(2)), ("proved", "ä"));
        assert!(verdicts.is_null(1));
        assert!(!batch.column(3).as_boolean().value(1));
    }

    #[test]
    fn the_same_table_gives_the_same_bytes() {
        let about = [("b", "1".to_string()), ("a", "2".to_string())];
        let bytes = || to_bytes(&columns(), &about).unwrap();
        assert_eq!(bytes(), bytes());
    }

    #[test]
    fn columns_of_different_lengths_are_refused() {
        let mut columns = columns();
        columns[1].cells = Arc::new(Int64Array::from(vec![1]));
        let error = to_bytes(&columns, &[]).unwrap_err().to_string();
        assert!(error.contains("same length"), "{error}");
    }
}
