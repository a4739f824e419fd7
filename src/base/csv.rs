//! Comma-separated values.

/// The table could not be put together.
#[derive(Debug, thiserror::Error)]
#[error("the table cannot be written: {0}")]
pub struct CsvError(#[from] ::csv::Error);

/// A text of records, each with its end of line; a field is quoted where it must be.
///
/// # Errors
/// Records of different lengths.
pub fn to_text<R, F>(records: impl IntoIterator<Item = R>) -> Result<String, CsvError>
where
    R: IntoIterator<Item = F>,
    F: AsRef<[u8]>,
{
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    for record in records {
        writer.write_record(record)?;
    }
    let bytes = writer
        .into_inner()
        .map_err(|error| ::csv::Error::from(error.into_error()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// A field in quotes, whether it needs them or not.
pub fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}
