//! The tables of a campaign: rows in, rows out, a bounded number at a time.
//!
//! The bytes of a table depend on its rows and its metadata only, not on how the rows were made.

use std::fmt::Display;
use std::fs::File;
use std::io::Write;
use std::path::Path;

use arrow_array::{Array, BooleanArray, Float32Array, Float64Array, RecordBatch};
use arrow_array::{StringArray, UInt64Array};
use arrow_schema::{ArrowError, SchemaRef};
use parquet::arrow::arrow_reader::{ParquetRecordBatchReader, ParquetRecordBatchReaderBuilder};
use parquet::arrow::{ArrowWriter, ProjectionMask};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::EnabledStatistics;
use parquet::schema::types::ColumnPath;

use super::record::ProfileGrid;
use super::row::RunRow;
use super::CampaignError;
use crate::base::files::OutputError;
use crate::base::guarded::guarded;
use crate::base::parquet::{batch, properties, Column};
use crate::sim::metrics::METRICS;

/// Key of the file metadata that holds the campaign's inputs.
pub const INPUTS_KEY: &str = "steadfast.campaign";
/// Key of the file metadata that holds the times of the profiles.
pub const TIMES_KEY: &str = "steadfast.profile_times_s";
/// Prefix of the columns of drawn numbers.
pub(super) const DRAWN: &str = "drawn.";
/// Rows that are held at a time.
const BATCH: usize = 1024;
/// Rows of a row group.
const ROW_GROUP: usize = 8 * BATCH;
/// Columns before the metrics, and the places of some of them.
const FIRST_COLUMNS: usize = 8;
pub(super) const RUN_COLUMN: usize = 0;
pub(super) const VERDICT_COLUMN: usize = 2;
pub(super) const COVERS_COLUMN: usize = 4;
pub(super) const MARGIN_COLUMN: usize = 7;

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
    /// The profile.
    pub profile: ProfileGrid,
}

impl CampaignColumns {
    /// Columns of a table with everything that a table of this content has.
    fn places(&self, content: Content) -> Vec<usize> {
        let profile = FIRST_COLUMNS + METRICS.len() + self.drawn.len();
        let end = profile + self.profile.quantities.len() * self.profile.times_s.len();
        match content {
            Content::Runs => (0..profile).collect(),
            Content::Profiles => std::iter::once(0).chain(profile..end).collect(),
            Content::Whole => (0..end).collect(),
        }
    }

    /// Every column of some rows.
    fn columns(&self, rows: &[RunRow]) -> Vec<Column> {
        let complete = |column| Column {
            complete: true,
            ..column
        };
        let whole = |name, of: fn(&RunRow) -> u64| {
            let cells = UInt64Array::from_iter_values(rows.iter().map(of));
            complete(Column::new(name, "", cells))
        };
        let flag = |name, of: fn(&RunRow) -> Option<bool>| {
            Column::new(name, "", rows.iter().map(of).collect::<BooleanArray>())
        };
        let number = |name: &str, of: &dyn Fn(&RunRow) -> Option<f64>| {
            Column::new(name, "", rows.iter().map(of).collect::<Float64Array>())
        };
        let verdicts = StringArray::from_iter_values(rows.iter().map(|row| row.verdict.name()));
        let worst = rows.iter().map(|row| row.worst.as_ref());
        let worst: StringArray = worst.map(|worst| worst.map(|(name, _)| name)).collect();
        let mut columns = vec![
            whole("run", |row| row.run),
            whole("seed", |row| row.seed),
            complete(Column::new("verdict", "", verdicts)),
            complete(flag("passed", |row| Some(row.passed()))),
            flag("proof_covers", |row| row.proof_covers),
            number("start_level", &|row| row.start_level),
            Column::new("worst_requirement", "", worst),
            number("worst_margin", &|row| Some(row.worst.as_ref()?.1)),
        ];
        let metrics = METRICS.iter().enumerate();
        columns.extend(metrics.map(|(index, entry)| number(entry.key, &|row| row.metrics[index])));
        let drawn = self.drawn.iter().enumerate();
        columns.extend(drawn.map(|(index, name)| {
            let value = |row: &RunRow| row.drawn.get(index).copied().flatten();
            number(&format!("{DRAWN}{name}"), &value)
        }));
        let times = self.profile.times_s.len();
        for (index, quantity) in self.profile.quantities.iter().enumerate() {
            columns.extend((0..times).map(|time| {
                let value = |row: &RunRow| row.profile.get(index * times + time).copied();
                let finite = rows
                    .iter()
                    .map(|row| value(row).filter(|value| value.is_finite()));
                let cells: Float32Array = finite.collect();
                Column::new(format!("{quantity}_{time:03}"), "", cells)
            }));
        }
        columns
    }

    fn schema(&self, content: Content) -> Result<SchemaRef, CampaignError> {
        let none = batch(self.columns(&[])).and_then(|none| none.project(&self.places(content)));
        Ok(none.map_err(refused)?.schema())
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
    let mut table = writer(path, Vec::new(), columns, Content::Whole, inputs)?;
    let rows = batch(columns.columns(rows)).map_err(refused)?;
    let written = table.write(&rows).and_then(|()| table.into_inner());
    written.map_err(|error| unwritten(path, error))
}

/// A table of rows in the order of their index, with the campaign's inputs (a JSON text) in its metadata.
/// `path` is for error messages.
///
/// # Errors
/// A schema that the library refuses.
pub fn writer<W: Write + Send>(
    path: &Path,
    to: W,
    columns: &CampaignColumns,
    content: Content,
    inputs: &str,
) -> Result<ArrowWriter<W>, CampaignError> {
    let mut metadata = vec![KeyValue::new(INPUTS_KEY.to_string(), inputs.to_string())];
    if content != Content::Runs {
        let times = serde_json::to_string(&columns.profile.times_s).unwrap_or_default();
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
    writer.map_err(|error| unwritten(path, error))
}

/// A table that cannot be written, with the system's reason where there is one.
pub fn unwritten(path: &Path, error: ParquetError) -> CampaignError {
    let reason = match error {
        ParquetError::External(source) => source.to_string(),
        other => other.to_string(),
    };
    CampaignError::unsuitable(path, format!("cannot be written: {reason}"))
}

/// The rows of a table of the content `has`, which must have the campaign's columns and inputs, with the
/// columns of `wanted`.
///
/// # Errors
/// A file that cannot be read or that is of another campaign.
pub fn rows(
    path: &Path,
    columns: &CampaignColumns,
    (has, wanted): (Content, Content),
    inputs: &str,
) -> Result<impl Iterator<Item = Result<RecordBatch, CampaignError>>, CampaignError> {
    let builder = builder(path)?;
    let metadata = builder.metadata().file_metadata().key_value_metadata();
    let mut entries = metadata.into_iter().flatten();
    let own = entries.find(|entry| entry.key == INPUTS_KEY);
    let same = own.is_some_and(|own| own.value.as_deref() == Some(inputs));
    if !same || builder.schema().fields() != columns.schema(has)?.fields() {
        let reason = "belongs to another campaign".to_string();
        return Err(CampaignError::unsuitable(path, reason));
    }
    let mask = match has == wanted {
        true => ProjectionMask::all(),
        false => ProjectionMask::roots(builder.parquet_schema(), columns.places(wanted)),
    };
    let builder = builder.with_batch_size(BATCH).with_projection(mask);
    let mut batches = sound(path, || builder.build())?;
    let path = path.to_path_buf();
    Ok(std::iter::from_fn(move || next(&path, &mut batches)))
}

/// What a reader of the file gives; it panics on some damaged files.
fn sound<T, E: Display>(
    path: &Path,
    read: impl FnOnce() -> Result<T, E>,
) -> Result<T, CampaignError> {
    match guarded(read) {
        Some(read) => read.map_err(|error| CampaignError::broken(path, error)),
        None => Err(CampaignError::broken(path, "a page of it is damaged")),
    }
}

/// The next rows of a file.
fn next(
    path: &Path,
    batches: &mut ParquetRecordBatchReader,
) -> Option<Result<RecordBatch, CampaignError>> {
    sound(path, || batches.next().transpose()).transpose()
}

/// A column of some rows.
///
/// # Errors
/// A column that is not of its type.
pub(super) fn typed<T: Array + 'static>(
    rows: &RecordBatch,
    column: usize,
) -> Result<&T, CampaignError> {
    let array = rows.columns().get(column);
    let array = array.and_then(|array| array.as_any().downcast_ref::<T>());
    array.ok_or_else(mistyped)
}

/// A column is not of its type.
pub(super) fn mistyped() -> CampaignError {
    CampaignError::Table("a column is not of its type".to_string())
}

fn builder(path: &Path) -> Result<ParquetRecordBatchReaderBuilder<File>, CampaignError> {
    let file = File::open(path);
    let file = file.map_err(|source| OutputError::io(path, "cannot be read", source))?;
    sound(path, || ParquetRecordBatchReaderBuilder::try_new(file))
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
        let texts = array.as_any().downcast_ref::<StringArray>()?.iter();
        Some(texts.map(|text| text.map(str::to_string)).collect())
    })
}

fn column<T>(
    path: &Path,
    name: &str,
    values: impl Fn(&dyn Array) -> Option<Vec<T>>,
) -> Result<Vec<T>, CampaignError> {
    let builder = builder(path)?;
    let missing = || {
        let reason = format!("has no column '{name}' of the type that is needed");
        CampaignError::unsuitable(path, reason)
    };
    let index = builder.schema().index_of(name).map_err(|_| missing())?;
    let mask = ProjectionMask::roots(builder.parquet_schema(), [index]);
    let mut batches = sound(path, || builder.with_projection(mask).build())?;
    let mut out = Vec::new();
    while let Some(batch) = next(path, &mut batches) {
        let batch = batch?;
        out.extend(values(batch.column(0).as_ref()).ok_or_else(missing)?);
    }
    Ok(out)
}
