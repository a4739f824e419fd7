//! Tables as Parquet files: typed columns with units, and text about the table in the file itself.
//!
//! The bytes depend on the table alone: the same table gives the same file.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use arrow_array::{ArrayRef, BooleanArray, Float64Array, Int64Array, RecordBatch, StringArray};
use arrow_schema::{DataType, Field, Schema};
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{WriterProperties, WriterPropertiesBuilder};
use synth::model::{write_atomically, FileError};

use super::files::OutputError;
use super::provenance::GENERATOR;

/// Most rows of a row group.
const GROUP_ROWS: usize = 65_536;

/// Key of a column's unit in its metadata.
pub const UNIT_KEY: &str = "unit";

/// The entries of a column; `None` is a missing entry.
#[derive(Debug, Clone, PartialEq)]
pub enum Cells {
    /// Floating-point numbers.
    Real(Vec<Option<f64>>),
    /// Whole numbers.
    Whole(Vec<Option<i64>>),
    /// Texts.
    Text(Vec<Option<String>>),
    /// Yes or no.
    Flag(Vec<Option<bool>>),
}

/// A named column.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Its unit, such as `N m`; empty where it has none.
    pub unit: String,
    /// Its entries.
    pub cells: Cells,
}

/// Why columns make no Parquet file.
#[derive(Debug, thiserror::Error)]
#[error("the table cannot be written as Parquet: {0}")]
pub struct ParquetError(String);

impl Cells {
    /// Number of entries.
    pub fn rows(&self) -> usize {
        match self {
            Cells::Real(cells) => cells.len(),
            Cells::Whole(cells) => cells.len(),
            Cells::Text(cells) => cells.len(),
            Cells::Flag(cells) => cells.len(),
        }
    }

    /// An entry as text that reads back exactly; empty where it is missing.
    pub fn text(&self, row: usize) -> String {
        fn shown<T: ToString>(cells: &[Option<T>], row: usize) -> String {
            let cell = cells.get(row).and_then(Option::as_ref);
            cell.map_or(String::new(), T::to_string)
        }
        match self {
            Cells::Real(cells) => shown(cells, row),
            Cells::Whole(cells) => shown(cells, row),
            Cells::Text(cells) => shown(cells, row),
            Cells::Flag(cells) => shown(cells, row),
        }
    }

    fn data_type(&self) -> DataType {
        match self {
            Cells::Real(_) => DataType::Float64,
            Cells::Whole(_) => DataType::Int64,
            Cells::Text(_) => DataType::Utf8,
            Cells::Flag(_) => DataType::Boolean,
        }
    }

    fn array(&self) -> ArrayRef {
        match self {
            Cells::Real(cells) => Arc::new(Float64Array::from_iter(cells.iter().copied())),
            Cells::Whole(cells) => Arc::new(Int64Array::from_iter(cells.iter().copied())),
            Cells::Text(cells) => Arc::new(StringArray::from_iter(cells.iter().cloned())),
            Cells::Flag(cells) => Arc::new(BooleanArray::from_iter(cells.iter().copied())),
        }
    }
}

impl Column {
    fn field(&self) -> Field {
        let field = Field::new(&self.name, self.cells.data_type(), true);
        match self.unit.as_str() {
            "" => field,
            unit => field.with_metadata(HashMap::from([(UNIT_KEY.to_string(), unit.to_string())])),
        }
    }
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
    let failed = |error: &dyn std::fmt::Display| ParquetError(error.to_string());
    let fields: Vec<Field> = columns.iter().map(Column::field).collect();
    // Readers by way of Arrow look for the texts in the schema, others in the file's metadata.
    let texts = about
        .iter()
        .map(|(key, text)| (key.to_string(), text.clone()));
    let schema = Arc::new(Schema::new_with_metadata(fields, texts.collect()));
    let about = about
        .iter()
        .map(|(key, text)| KeyValue::new(key.to_string(), text.clone()));
    let properties = properties(about.collect())
        .set_max_row_group_size(GROUP_ROWS)
        .build();
    let mut writer = ArrowWriter::try_new(Vec::new(), Arc::clone(&schema), Some(properties))
        .map_err(|error| failed(&error))?;
    if !columns.is_empty() {
        let arrays = columns.iter().map(|column| column.cells.array()).collect();
        let batch = RecordBatch::try_new(schema, arrays).map_err(|error| failed(&error))?;
        writer.write(&batch).map_err(|error| failed(&error))?;
    }
    writer.into_inner().map_err(|error| failed(&error))
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
    let failed = |problem| OutputError::File {
        path: path.to_path_buf(),
        problem,
    };
    let bytes = to_bytes(columns, about).map_err(|error| {
        failed(FileError::Io {
            action: "cannot be written",
            source: std::io::Error::other(error),
        })
    })?;
    write_atomically(path, &bytes).map_err(failed)
}

#[cfg(test)]
mod tests {
    use arrow_array::cast::AsArray;
    use arrow_array::types::{Float64Type, Int64Type};
    use arrow_array::Array;
    use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;

    use super::*;

    fn columns() -> Vec<Column> {
        let column = |name: &str, unit: &str, cells| Column {
            name: name.to_string(),
            unit: unit.to_string(),
            cells,
        };
        let text = |text: &str| Some(text.to_string());
        vec![
            column(
                "angle_deg",
                "deg",
                Cells::Real(vec![Some(0.1), None, Some(-0.0)]),
            ),
            column("triggers", "", Cells::Whole(vec![Some(3), Some(-4), None])),
            column(
                "verdict",
                "",
                Cells::Text(vec![text("proved"), None, text("ä")]),
            ),
            column("met", "", Cells::Flag(vec![Some(true), Some(false), None])),
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
        columns[1].cells = Cells::Whole(vec![Some(1)]);
        let error = to_bytes(&columns, &[]).unwrap_err().to_string();
        assert!(error.contains("same length"), "{error}");
    }
}
