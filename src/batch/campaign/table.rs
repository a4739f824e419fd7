//! The tables of a campaign as Parquet: rows in, rows out, a bounded number at a time.
//!
//! The bytes of a table depend on its rows and its metadata only, not on how the rows were made.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow_array::{Array, ArrayRef, BooleanArray, Float32Array, Float64Array, RecordBatch};
use arrow_array::{StringArray, UInt64Array};
use arrow_schema::{DataType, Field, Schema, SchemaRef};
use parquet::arrow::arrow_reader::{ParquetRecordBatchReader, ParquetRecordBatchReaderBuilder};
use parquet::arrow::{ArrowWriter, ProjectionMask};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::EnabledStatistics;
use parquet::schema::types::ColumnPath;

use super::row::{metric_columns, Row};
use super::CampaignError;
use crate::base::parquet::properties;
use crate::run::summary::RunVerdict;
use crate::sim::metrics::METRICS;

/// Key of the file metadata that holds the campaign's inputs.
pub const INPUTS_KEY: &str = "steadfast.campaign";
/// Key of the file metadata that holds the times of the profiles.
pub const TIMES_KEY: &str = "steadfast.profile_times_s";
/// Rows that are held at a time.
const BATCH: usize = 1024;
/// Rows of a row group.
const ROW_GROUP: usize = 8 * BATCH;
/// Columns before the metrics.
const FIRST_COLUMNS: usize = 8;

/// Which part of the rows a table holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// Everything but the profile.
    Runs,
    /// The index and the profile.
    Profiles,
    /// Everything: a part that is not merged yet.
    Whole,
}

/// The columns of a campaign's tables.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    /// Names of the drawn numbers, without `drawn.`.
    pub drawn: Vec<String>,
    /// Quantities of the profile.
    pub quantities: Vec<String>,
    /// Times of the profile, s.
    pub times_s: Vec<f64>,
}

impl Columns {
    /// Numbers in the profile of a run.
    pub fn profile_len(&self) -> usize {
        self.quantities.len() * self.times_s.len()
    }

    fn schema(&self, content: Content) -> SchemaRef {
        let mut fields = vec![Field::new("run", DataType::UInt64, false)];
        if content != Content::Profiles {
            fields.extend([
                Field::new("seed", DataType::UInt64, false),
                Field::new("verdict", DataType::Utf8, false),
                Field::new("passed", DataType::Boolean, false),
                Field::new("proof_covers", DataType::Boolean, true),
                Field::new("start_level", DataType::Float64, true),
                Field::new("worst_requirement", DataType::Utf8, true),
                Field::new("worst_margin", DataType::Float64, true),
            ]);
            let drawn = self.drawn.iter().map(|name| format!("drawn.{name}"));
            let numbers = metric_columns().into_iter().chain(drawn);
            fields.extend(numbers.map(|name| Field::new(name, DataType::Float64, true)));
        }
        if content != Content::Runs {
            for quantity in &self.quantities {
                let times = 0..self.times_s.len();
                let names = times.map(|time| format!("{quantity}_{time:03}"));
                fields.extend(names.map(|name| Field::new(name, DataType::Float32, true)));
            }
        }
        Arc::new(Schema::new(fields))
    }

    fn batch(&self, content: Content, rows: &[Row]) -> Result<RecordBatch, CampaignError> {
        let mut arrays: Vec<ArrayRef> = vec![Arc::new(UInt64Array::from_iter_values(
            rows.iter().map(|row| row.run),
        ))];
        if content != Content::Profiles {
            let number = |value: &dyn Fn(&Row) -> Option<f64>| -> ArrayRef {
                Arc::new(Float64Array::from_iter(rows.iter().map(value)))
            };
            let worst = |row: &Row| row.worst.as_ref().map(|(name, _)| name.clone());
            arrays.push(Arc::new(UInt64Array::from_iter_values(
                rows.iter().map(|row| row.seed),
            )));
            arrays.push(Arc::new(StringArray::from_iter_values(
                rows.iter().map(|row| row.verdict.name()),
            )));
            arrays.push(Arc::new(BooleanArray::from_iter(
                rows.iter().map(|row| Some(row.passed())),
            )));
            arrays.push(Arc::new(BooleanArray::from_iter(
                rows.iter().map(|row| row.proof_covers),
            )));
            arrays.push(number(&|row| row.start_level));
            arrays.push(Arc::new(StringArray::from_iter(rows.iter().map(worst))));
            arrays.push(number(&|row| row.worst.as_ref().map(|(_, margin)| *margin)));
            for index in 0..METRICS.len() {
                arrays.push(number(&|row| row.metrics.get(index).copied().flatten()));
            }
            for index in 0..self.drawn.len() {
                arrays.push(number(&|row| row.drawn.get(index).copied().flatten()));
            }
        }
        if content != Content::Runs {
            for index in 0..self.profile_len() {
                let value = |row: &Row| {
                    let value = row.profile.get(index).copied();
                    value.filter(|value| value.is_finite())
                };
                arrays.push(Arc::new(Float32Array::from_iter(rows.iter().map(value))));
            }
        }
        RecordBatch::try_new(self.schema(content), arrays)
            .map_err(|error| CampaignError::Table(error.to_string()))
    }
}

/// Writes rows in the order of their index.
pub struct TableWriter<'a, W: Write + Send> {
    path: PathBuf,
    columns: &'a Columns,
    content: Content,
    writer: ArrowWriter<W>,
    waiting: Vec<Row>,
}

impl<'a, W: Write + Send> TableWriter<'a, W> {
    /// A table with the campaign's inputs (a JSON text) in its metadata. `path` is for error messages.
    ///
    /// # Errors
    /// A schema that the library refuses.
    pub fn new(
        path: &Path,
        to: W,
        columns: &'a Columns,
        content: Content,
        inputs: &str,
    ) -> Result<Self, CampaignError> {
        let mut metadata = vec![KeyValue::new(INPUTS_KEY.to_string(), inputs.to_string())];
        if content != Content::Runs {
            let times = serde_json::to_string(&columns.times_s).unwrap_or_default();
            metadata.push(KeyValue::new(TIMES_KEY.to_string(), times));
        }
        let properties = properties(metadata)
            // Hardly a number comes twice; texts do.
            .set_dictionary_enabled(false)
            .set_column_dictionary_enabled(ColumnPath::from("verdict"), true)
            .set_column_dictionary_enabled(ColumnPath::from("worst_requirement"), true)
            .set_statistics_enabled(EnabledStatistics::Chunk)
            .set_max_row_group_size(ROW_GROUP)
            .build();
        let writer = ArrowWriter::try_new(to, columns.schema(content), Some(properties));
        Ok(TableWriter {
            path: path.to_path_buf(),
            columns,
            content,
            writer: writer.map_err(|error| unwritten(path, &error))?,
            waiting: Vec::new(),
        })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// A disk that is full.
    pub fn push(&mut self, row: Row) -> Result<(), CampaignError> {
        self.waiting.push(row);
        if self.waiting.len() == BATCH {
            self.write()?;
        }
        Ok(())
    }

    fn write(&mut self) -> Result<(), CampaignError> {
        let batch = self.columns.batch(self.content, &self.waiting)?;
        self.waiting.clear();
        let written = self.writer.write(&batch);
        written.map_err(|error| unwritten(&self.path, &error))
    }

    /// Writes what is left and the end of the file.
    ///
    /// # Errors
    /// A disk that is full.
    pub fn finish(mut self) -> Result<W, CampaignError> {
        if !self.waiting.is_empty() {
            self.write()?;
        }
        let ended = self.writer.into_inner();
        ended.map_err(|error| unwritten(&self.path, &error))
    }
}

/// The system's reason where there is one.
fn unwritten(path: &Path, error: &ParquetError) -> CampaignError {
    let reason = match error {
        ParquetError::External(source) => source.to_string(),
        other => other.to_string(),
    };
    CampaignError::Unsuitable {
        path: path.to_path_buf(),
        reason: format!("cannot be written: {reason}"),
    }
}

/// Reads a table with every column, or with the profile alone.
pub struct TableReader {
    batches: ParquetRecordBatchReader,
    drawn: usize,
    content: Content,
}

impl TableReader {
    /// Opens a table of that content, which must have the campaign's columns and inputs.
    ///
    /// # Errors
    /// A file that cannot be read or that is of another campaign.
    pub fn open(
        path: &Path,
        columns: &Columns,
        content: Content,
        inputs: &str,
    ) -> Result<Self, CampaignError> {
        let builder = builder(path)?;
        let own = inputs_of(&builder);
        if own.as_deref() != Some(inputs) || !same_fields(&builder, &columns.schema(content)) {
            return Err(CampaignError::Unsuitable {
                path: path.to_path_buf(),
                reason: "belongs to another campaign".to_string(),
            });
        }
        let broken = |error| CampaignError::broken(path, error);
        Ok(TableReader {
            batches: builder.with_batch_size(BATCH).build().map_err(broken)?,
            drawn: columns.drawn.len(),
            content,
        })
    }

    fn rows(&self, batch: &RecordBatch) -> Option<Vec<Row>> {
        (0..batch.num_rows())
            .map(|index| row_of(batch, index, self.content, self.drawn))
            .collect()
    }
}

impl Iterator for TableReader {
    type Item = Result<Vec<Row>, CampaignError>;

    fn next(&mut self) -> Option<Self::Item> {
        let failed = |what: String| CampaignError::Table(what);
        Some(match self.batches.next()? {
            Err(error) => Err(failed(error.to_string())),
            Ok(batch) => self
                .rows(&batch)
                .ok_or_else(|| failed("a column is not of its type".to_string())),
        })
    }
}

fn row_of(batch: &RecordBatch, index: usize, content: Content, drawn: usize) -> Option<Row> {
    let integer = |column: usize| Some(cast::<UInt64Array>(batch, column)?.value(index));
    let numbers = |from: usize, count: usize| -> Option<Vec<Option<f64>>> {
        let one = |column: usize| {
            let array = cast::<Float64Array>(batch, column)?;
            Some(array.is_valid(index).then(|| array.value(index)))
        };
        (from..from + count).map(one).collect()
    };
    let profile = |from: usize| -> Option<Vec<f32>> {
        let one = |column: usize| {
            let array = cast::<Float32Array>(batch, column)?;
            Some(match array.is_valid(index) {
                true => array.value(index),
                false => f32::NAN,
            })
        };
        (from..batch.num_columns()).map(one).collect()
    };
    let mut row = Row {
        run: integer(0)?,
        seed: 0,
        verdict: RunVerdict::RequirementsMet,
        proof_covers: None,
        start_level: None,
        worst: None,
        metrics: Vec::new(),
        drawn: Vec::new(),
        profile: Vec::new(),
    };
    if content == Content::Profiles {
        row.profile = profile(1)?;
        return Some(row);
    }
    let text = |column: usize| -> Option<Option<String>> {
        let array = cast::<StringArray>(batch, column)?;
        Some(
            array
                .is_valid(index)
                .then(|| array.value(index).to_string()),
        )
    };
    let covers = cast::<BooleanArray>(batch, 4)?;
    row.seed = integer(1)?;
    row.verdict = RunVerdict::named(&text(2)??)?;
    row.proof_covers = covers.is_valid(index).then(|| covers.value(index));
    let first = numbers(5, 1)?;
    row.start_level = first.first().copied().flatten();
    row.worst = text(6)?.zip(numbers(7, 1)?.first().copied().flatten());
    row.metrics = numbers(FIRST_COLUMNS, METRICS.len())?;
    row.drawn = numbers(FIRST_COLUMNS + METRICS.len(), drawn)?;
    if content == Content::Whole {
        row.profile = profile(FIRST_COLUMNS + METRICS.len() + drawn)?;
    }
    Some(row)
}

fn cast<T: Array + 'static>(batch: &RecordBatch, column: usize) -> Option<&T> {
    batch.columns().get(column)?.as_any().downcast_ref::<T>()
}

type Builder = ParquetRecordBatchReaderBuilder<File>;

fn builder(path: &Path) -> Result<Builder, CampaignError> {
    let file = File::open(path).map_err(|source| CampaignError::read(path, source))?;
    Builder::try_new(file).map_err(|error| CampaignError::broken(path, error))
}

fn inputs_of(builder: &Builder) -> Option<String> {
    let metadata = builder.metadata().file_metadata().key_value_metadata()?;
    let own = metadata.iter().find(|entry| entry.key == INPUTS_KEY)?;
    own.value.clone()
}

fn same_fields(builder: &Builder, schema: &Schema) -> bool {
    builder.schema().fields() == schema.fields()
}

/// The names of a table's columns.
///
/// # Errors
/// A file that is no table.
pub fn column_names(path: &Path) -> Result<Vec<String>, CampaignError> {
    let builder = builder(path)?;
    let fields = builder.schema().fields().iter();
    Ok(fields.map(|field| field.name().clone()).collect())
}

/// One column of numbers or yes and no (1 and 0). Reads nothing else of the file.
///
/// # Errors
/// A file that is no table, no column of that name, a column of texts.
pub fn column_f64(path: &Path, name: &str) -> Result<Vec<Option<f64>>, CampaignError> {
    column(path, name, |array| {
        let any = array.as_any();
        if let Some(values) = any.downcast_ref::<Float64Array>() {
            return Some(values.iter().collect());
        }
        if let Some(values) = any.downcast_ref::<Float32Array>() {
            return Some(values.iter().map(|value| value.map(f64::from)).collect());
        }
        if let Some(values) = any.downcast_ref::<UInt64Array>() {
            return Some(values.iter().map(|value| value.map(|v| v as f64)).collect());
        }
        let values = any.downcast_ref::<BooleanArray>()?;
        let number = |value: bool| f64::from(u8::from(value));
        Some(values.iter().map(|value| value.map(number)).collect())
    })
}

/// One column of texts. Reads nothing else of the file.
///
/// # Errors
/// A file that is no table, no column of that name, a column of numbers.
pub fn column_text(path: &Path, name: &str) -> Result<Vec<Option<String>>, CampaignError> {
    column(path, name, |array| {
        let values = array.as_any().downcast_ref::<StringArray>()?;
        Some(
            values
                .iter()
                .map(|value| value.map(str::to_string))
                .collect(),
        )
    })
}

fn column<T>(
    path: &Path,
    name: &str,
    values: impl Fn(&dyn Array) -> Option<Vec<T>>,
) -> Result<Vec<T>, CampaignError> {
    let builder = builder(path)?;
    let missing = || CampaignError::Unsuitable {
        path: path.to_path_buf(),
        reason: format!("has no column '{name}' of the type that is needed"),
    };
    let index = builder.schema().index_of(name).map_err(|_| missing())?;
    let mask = ProjectionMask::roots(builder.parquet_schema(), [index]);
    let batches = builder.with_projection(mask).build();
    let mut out = Vec::new();
    for batch in batches.map_err(|error| CampaignError::broken(path, error))? {
        let batch = batch.map_err(|error| CampaignError::broken(path, error))?;
        out.extend(values(batch.column(0).as_ref()).ok_or_else(missing)?);
    }
    Ok(out)
}
