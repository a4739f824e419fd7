//! Reading the project's files by path.

use std::path::Path;

use synth::design::DesignFile;
use synth::model::{read_text, FileError, Gains, Model};

use super::CliError;

/// A model file: its text and its checked content.
pub fn model(path: &Path) -> Result<(String, Model), CliError> {
    let read = || -> Result<(String, Model), FileError> {
        let text = read_text(path)?;
        let model = Model::from_json(&text)?;
        Ok((text, model))
    };
    read().map_err(|problem| CliError::file(path, problem))
}

/// A gains file: its text and its checked content.
pub fn gains(path: &Path) -> Result<(String, Gains), CliError> {
    let read = || -> Result<(String, Gains), FileError> {
        let text = read_text(path)?;
        let gains = Gains::from_json(&text)?;
        Ok((text, gains))
    };
    read().map_err(|problem| CliError::file(path, problem))
}

/// A design file and the checked model inside it.
pub fn design(path: &Path) -> Result<(DesignFile, Model), CliError> {
    let read = || DesignFile::from_json(&read_text(path)?);
    read().map_err(|problem| CliError::file(path, problem))
}

/// Refuses an output path that cannot be written or that is the input, before any long work.
pub fn check_output(path: &Path, input: &Path) -> Result<(), CliError> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    if path.is_dir() {
        return Err(CliError::unsuitable(
            path,
            "this is a folder; a file name is needed",
        ));
    }
    if !folder.is_dir() {
        return Err(CliError::unsuitable(
            path,
            "cannot be written: its folder does not exist",
        ));
    }
    if path.exists() && !path.is_file() {
        return Err(CliError::unsuitable(
            path,
            "cannot be written: it is not an ordinary file",
        ));
    }
    let same = |a: &Path, b: &Path| Some(a.canonicalize().ok()? == b.canonicalize().ok()?);
    if same(path, input) == Some(true) {
        return Err(CliError::unsuitable(
            path,
            "this is the input; it would be overwritten",
        ));
    }
    Ok(())
}

/// Writes a result file whole or not at all.
pub fn write(path: &Path, contents: &str) -> Result<(), CliError> {
    synth::model::write_atomically(path, contents.as_bytes())
        .map_err(|problem| CliError::file(path, problem))
}
