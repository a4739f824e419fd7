//! Reading and writing files by path.

use std::path::Path;

use synth::model::FileError;

use super::error::CliError;
use crate::base::files::read;

/// A file's text.
pub fn text(path: &Path) -> Result<String, CliError> {
    Ok(read(path)?)
}

/// The checked content of a file with this text, such as by `Model::from_json`.
pub fn parse<T>(
    path: &Path,
    text: &str,
    from_json: impl FnOnce(&str) -> Result<T, FileError>,
) -> Result<T, CliError> {
    from_json(text).map_err(|problem| CliError::file(path, problem))
}

/// A file's text and its checked content.
pub fn load<T>(
    path: &Path,
    from_json: impl FnOnce(&str) -> Result<T, FileError>,
) -> Result<(String, T), CliError> {
    let text = text(path)?;
    let content = parse(path, &text, from_json)?;
    Ok((text, content))
}

/// Writes a result file whole or not at all.
pub fn write(path: &Path, contents: impl AsRef<[u8]>) -> Result<(), CliError> {
    Ok(crate::base::files::write(path, &contents)?)
}
