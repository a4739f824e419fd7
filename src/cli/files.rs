//! Reading the project's files by path.

use std::path::Path;

use synth::design::DesignFile;
use synth::feasibility::InfeasibilityFile;
use synth::model::{read_text, GainsFile, Model};
use synth::problem::{Problem, ProblemDesignFile};

use super::error::CliError;
use crate::batch::tune::file::Requirements;
use crate::scenario::Scenario;

/// A file's text.
pub fn text(path: &Path) -> Result<String, CliError> {
    read_text(path).map_err(|problem| CliError::file(path, problem))
}

/// The checked content of a model file with this text.
pub fn model_of(path: &Path, text: &str) -> Result<Model, CliError> {
    Model::from_json(text).map_err(|problem| CliError::file(path, problem))
}

/// A design file with this text, and the checked model inside it.
pub fn design_of(path: &Path, text: &str) -> Result<(DesignFile, Model), CliError> {
    DesignFile::from_json(text).map_err(|problem| CliError::file(path, problem))
}

/// The checked content of a problem file with this text.
pub fn problem_of(path: &Path, text: &str) -> Result<Problem, CliError> {
    Problem::from_json(text).map_err(|problem| CliError::file(path, problem))
}

/// The design file of a problem with this text, and the checked problem inside it.
pub fn problem_design_of(
    path: &Path,
    text: &str,
) -> Result<(ProblemDesignFile, Problem), CliError> {
    ProblemDesignFile::from_json(text).map_err(|problem| CliError::file(path, problem))
}

/// An infeasibility certificate with this text, and the checked model inside it.
pub fn infeasibility_of(path: &Path, text: &str) -> Result<(InfeasibilityFile, Model), CliError> {
    InfeasibilityFile::from_json(text).map_err(|problem| CliError::file(path, problem))
}

/// The checked content of a scenario file with this text.
pub fn scenario_of(path: &Path, text: &str) -> Result<Scenario, CliError> {
    Scenario::from_json(text).map_err(|problem| CliError::file(path, problem))
}

/// The checked content of a requirements file with this text.
pub fn requirements_of(path: &Path, text: &str) -> Result<Requirements, CliError> {
    Requirements::from_json(text).map_err(|problem| CliError::file(path, problem))
}

/// The checked content of a gains file with this text.
pub fn gains_of(path: &Path, text: &str) -> Result<GainsFile, CliError> {
    GainsFile::from_json(text).map_err(|problem| CliError::file(path, problem))
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

/// Refuses an output folder that is something else, before any long work.
pub fn check_folder(path: &Path) -> Result<(), CliError> {
    match path.exists() && !path.is_dir() {
        true => Err(CliError::unsuitable(
            path,
            "this is a file; a folder is needed",
        )),
        false => Ok(()),
    }
}

/// Writes a result file whole or not at all.
pub fn write(path: &Path, contents: &str) -> Result<(), CliError> {
    write_bytes(path, contents.as_bytes())
}

/// As [`write`], for any bytes.
pub fn write_bytes(path: &Path, contents: &[u8]) -> Result<(), CliError> {
    synth::model::write_atomically(path, contents).map_err(|problem| CliError::file(path, problem))
}
