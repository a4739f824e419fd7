//! Reading and writing files by path.

use std::path::Path;

use synth::model::{write_atomically, FileError};

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

/// Refuses an output path that cannot be written or that is an input, before any long work.
pub fn check_output(output: Option<&Path>, inputs: &[&Path]) -> Result<(), CliError> {
    let Some(path) = output else {
        return Ok(());
    };
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let same = |input: &&Path| Some(path.canonicalize().ok()? == input.canonicalize().ok()?);
    let reason = if path.is_dir() {
        "this is a folder; a file name is needed"
    } else if !folder.is_dir() {
        "cannot be written: its folder does not exist"
    } else if path.exists() && !path.is_file() {
        "cannot be written: it is not an ordinary file"
    } else if inputs.iter().any(|input| same(input) == Some(true)) {
        "this is the input; it would be overwritten"
    } else {
        return Ok(());
    };
    Err(CliError::unsuitable(path, reason))
}

/// Refuses an output folder that is something else, before any long work.
pub fn check_folder(path: Option<&Path>) -> Result<(), CliError> {
    match path {
        Some(path) if path.exists() && !path.is_dir() => Err(CliError::unsuitable(
            path,
            "this is a file; a folder is needed",
        )),
        _ => Ok(()),
    }
}

/// Writes a result file whole or not at all.
pub fn write(path: &Path, contents: impl AsRef<[u8]>) -> Result<(), CliError> {
    let written = write_atomically(path, contents.as_ref());
    written.map_err(|problem| CliError::file(path, problem))
}
