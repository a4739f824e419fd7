//! The tables of a campaign as Parquet: rows in, rows out, a bounded number at a time.
//!
//! The bytes of a table depend on its rows and its metadata only, not on how the rows were made.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow_array::{Array, ArrayRef, BooleanArray, Float32Array, Float64Array, RecordBatch};
use arrow_array::{StringArray, UInt64Array};
use arrow_schema::{ArrowError, DataType, Field, Schema, SchemaRef};
use parquet::arrow::arrow_reader::{ParquetRecordBatchReader, ParquetRecordBatchReaderBuilder};
use parquet::arrow::{ArrowWriter, ProjectionMask};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::EnabledStatistics;
use parquet::schema::types::ColumnPath;

use super::row::{metric_columns, RunRow};
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
/// Places of some of them.
const VERDICT_COLUMN: usize = 2;
const COVERS_COLUMN: usize = 4;
const MARGIN_COLUMN: usize = 7;

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
pub struct CampaignColumns {
    /// Names of the drawn numbers, without `drawn.`.
    pub drawn: Vec<String>,
    /// Quantities of the profile.
    pub quantities: Vec<String>,
    /// Times of the profile, s.
    pub times_s: Vec<f64>,
}

impl CampaignColumns {
    /// Numbers in the profile of a run.
    pub fn profile_len(&self) -> usize {
        self.quantities.len() * self.times_s.len()
    }

    /// Columns of a table with everything that a table of this content has.
    fn places(&self, content: Content) -> Vec<usize> {
        let profile = FIRST_COLUMNS + METRICS.len() + self.drawn.len();
        let end = profile + self.profile_len();
        match content {
            Content::Runs => (0..profile).collect(),
            Content::Profiles => std::iter::once(0).chain(profile..end).collect(),
            Content::Whole => (0..end).collect(),
        }
    }

    fn schema(&self, content: Content) -> Result<SchemaRef, CampaignError> {
        let mut fields = vec![
            Field::new("run", DataType::UInt64, false),
            Field::new("seed", DataType::UInt64, false),
            Field::new("verdict", DataType::Utf8, false),
            Field::new("passed", DataType::Boolean, false),
            Field::new("proof_covers", DataType::Boolean, true),
            Field::new("start_level", DataType::Float64, true),
            Field::new("worst_requirement", DataType::Utf8, true),
            Field::new("worst_margin", DataType::Float64, true),
        ];
        let drawn = self.drawn.iter().map(|name| format!("drawn.{name}"));
        let numbers = metric_columns().into_iter().chain(drawn);
        fields.extend(numbers.map(|name| Field::new(name, DataType::Float64, true)));
        for quantity in &self.quantities {
            let times = 0..self.times_s.len();
            let names = times.map(|time| format!("{quantity}_{time:03}"));
            fields.extend(names.map(|name| Field::new(name, DataType::Float32, true)));
        }
        let schema = Schema::new(fields).project(&self.places(content));
        Ok(Arc::new(schema.map_err(refused)?))
    }

    /// Rows with everything.
    fn batch(&self, rows: &[RunRow]) -> Result<RecordBatch, CampaignError> {
        let flag = |value: &dyn Fn(&RunRow) -> Option<bool>| -> ArrayRef {
            Arc::new(BooleanArray::from_iter(rows.iter().map(value)))
        };
        let number = |value: &dyn Fn(&RunRow) -> Option<f64>| -> ArrayRef {
            Arc::new(Float64Array::from_iter(rows.iter().map(value)))
        };
        let whole = |value: &dyn Fn(&RunRow) -> u64| -> ArrayRef {
            Arc::new(UInt64Array::from_iter_values(rows.iter().map(value)))
        };
        let verdicts = rows.iter().map(|row| row.verdict.name());
        let worst = rows.iter().map(|row| row.worst.as_ref());
        let worst = worst.map(|worst| worst.map(|(name, _)| name.as_str()));
        let mut arrays: Vec<ArrayRef> = vec![
            whole(&|row| row.run),
            whole(&|row| row.seed),
            Arc::new(StringArray::from_iter_values(verdicts)),
            flag(&|row| Some(row.passed())),
            flag(&|row| row.proof_covers),
            number(&|row| row.start_level),
            Arc::new(StringArray::from_iter(worst)),
            number(&|row| row.worst.as_ref().map(|(_, margin)| *margin)),
        ];
        for index in 0..METRICS.len() {
            arrays.push(number(&|row| row.metrics.get(index).copied().flatten()));
        }
        for index in 0..self.drawn.len() {
            arrays.push(number(&|row| row.drawn.get(index).copied().flatten()));
        }
        for index in 0..self.profile_len() {
            let value = |row: &RunRow| {
                let value = row.profile.get(index).copied();
                value.filter(|value| value.is_finite())
            };
            arrays.push(Arc::new(Float32Array::from_iter(rows.iter().map(value))));
        }
        RecordBatch::try_new(self.schema(Content::Whole)?, arrays).map_err(refused)
    }
}

fn refused(error: ArrowError) -> CampaignError {
    CampaignError::Table(error.to_string())
}

/// The bytes of a table with everything of some rows, with the campaign's inputs (a JSON text) in its
/// metadata. `path` is for error messages.
///
/// # Errors
/// A schema that the library refuses.
pub fn part_table(
    path: &Path,
    columns: &CampaignColumns,
    inputs: &str,
    rows: &[RunRow],
) -> Result<Vec<u8>, CampaignError> {
    let mut table = TableWriter::new(path, Vec::new(), columns, Content::Whole, inputs)?;
    for rows in rows.chunks(BATCH) {
        table.write(&columns.batch(rows)?)?;
    }
    table.finish()
}

/// Writes rows in the order of their index.
pub struct TableWriter<W: Write + Send> {
    path: PathBuf,
    writer: ArrowWriter<W>,
}

impl<W: Write + Send> TableWriter<W> {
    /// A table with the campaign's inputs (a JSON text) in its metadata. `path` is for error messages.
    ///
    /// # Errors
    /// A schema that the library refuses.
    pub fn new(
        path: &Path,
        to: W,
        columns: &CampaignColumns,
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
        let writer = ArrowWriter::try_new(to, columns.schema(content)?, Some(properties));
        Ok(TableWriter {
            path: path.to_path_buf(),
            writer: writer.map_err(|error| unwritten(path, &error))?,
        })
    }

    /// Adds rows, which have the table's columns.
    ///
    /// # Errors
    /// A disk that is full.
    pub fn write(&mut self, rows: &RecordBatch) -> Result<(), CampaignError> {
        let written = self.writer.write(rows);
        written.map_err(|error| unwritten(&self.path, &error))
    }

    /// Writes the end of the file.
    ///
    /// # Errors
    /// A disk that is full.
    pub fn finish(self) -> Result<W, CampaignError> {
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

/// Reads the rows of a table, with the columns of another content that it has.
pub struct TableReader {
    batches: ParquetRecordBatchReader,
}

impl TableReader {
    /// Opens a table of the content `has`, which must have the campaign's columns and inputs, for the columns
    /// of `wanted`.
    ///
    /// # Errors
    /// A file that cannot be read or that is of another campaign.
    pub fn open(
        path: &Path,
        columns: &CampaignColumns,
        (has, wanted): (Content, Content),
        inputs: &str,
    ) -> Result<Self, CampaignError> {
        let builder = builder(path)?;
        let own = inputs_of(&builder);
        let schema = columns.schema(has)?;
        if own.as_deref() != Some(inputs) || builder.schema().fields() != schema.fields() {
            return Err(CampaignError::Unsuitable {
                path: path.to_path_buf(),
                reason: "belongs to another campaign".to_string(),
            });
        }
        let mask = match has == wanted {
            true => ProjectionMask::all(),
            false => ProjectionMask::roots(builder.parquet_schema(), columns.places(wanted)),
        };
        let builder = builder.with_batch_size(BATCH).with_projection(mask);
        let broken = |error| CampaignError::broken(path, error);
        Ok(TableReader {
            batches: builder.build().map_err(broken)?,
        })
    }
}

impl Iterator for TableReader {
    type Item = Result<RecordBatch, CampaignError>;

    fn next(&mut self) -> Option<Self::Item> {
        Some(self.batches.next()?.map_err(refused))
    }
}

/// What is counted of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CountedRun {
    /// Its index.
    pub run: u64,
    /// The answer.
    pub verdict: RunVerdict,
    /// Whether the design's proof covers it.
    pub proof_covers: Option<bool>,
    /// Smallest margin of a requirement.
    pub margin: Option<f64>,
}

/// The indices of some rows of a table.
///
/// # Errors
/// A column that is not of its type.
pub fn run_indices(batch: &RecordBatch) -> Result<&[u64], CampaignError> {
    Ok(typed::<UInt64Array>(batch, 0)?.values())
}

/// What is counted of the runs in some rows of a table.
///
/// # Errors
/// A column that is not of its type, or a verdict that is none.
pub fn run_verdicts(batch: &RecordBatch) -> Result<Vec<CountedRun>, CampaignError> {
    let verdicts = typed::<StringArray>(batch, VERDICT_COLUMN)?;
    let covers = typed::<BooleanArray>(batch, COVERS_COLUMN)?;
    let margins = typed::<Float64Array>(batch, MARGIN_COLUMN)?;
    let runs = run_indices(batch)?.iter();
    let rows = runs.zip(verdicts).zip(covers).zip(margins);
    rows.map(|(((&run, verdict), proof_covers), margin)| {
        Ok(CountedRun {
            run,
            verdict: verdict.and_then(RunVerdict::named).ok_or_else(mistyped)?,
            proof_covers,
            margin,
        })
    })
    .collect()
}

fn typed<T: Array + 'static>(batch: &RecordBatch, column: usize) -> Result<&T, CampaignError> {
    let array = batch.columns().get(column);
    let array = array.and_then(|array| array.as_any().downcast_ref::<T>());
    array.ok_or_else(mistyped)
}

fn mistyped() -> CampaignError {
    CampaignError::Table("a column is not of its type".to_string())
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
