//! The files of a run: trajectory, summary, report.

use std::path::{Path, PathBuf};

use synth::model::{read_text, read_text_up_to, write_atomically, FileError};

use super::comparison::{self, Comparison, Curves};
use super::recorder::{Table, TableError};
use super::report;
use super::simulation::Outcome;
use super::summary::{Summary, SUMMARY_SCHEMA_VERSION};

/// Name of the trajectory's file.
pub const TRAJECTORY_FILE: &str = "trajectory.csv";
/// Name of the summary's file.
pub const SUMMARY_FILE: &str = "summary.json";
/// Name of the report's file.
pub const REPORT_FILE: &str = "report.html";

/// Name of a comparison's table.
pub const COMPARISON_FILE: &str = "comparison.json";
/// Name of a comparison's table as comma-separated values.
pub const COMPARISON_CSV: &str = "comparison.csv";
/// Name of a comparison's page.
pub const COMPARISON_PAGE: &str = "comparison.html";

/// Why a run's files cannot be written or read.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// A file cannot be read or written.
    #[error("{}: {problem}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: FileError,
    },
    /// A trajectory is no table.
    #[error("{}: {problem}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: TableError,
    },
    /// A summary is not one.
    #[error("{}: not a summary: {reason}", path.display())]
    Summary {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A figure cannot be drawn.
    #[error("the report's figures cannot be drawn: {0}")]
    Figure(#[from] report::FigureError),
}

/// Creates the folder and writes every file of a run into it, each under a temporary name first.
///
/// # Errors
/// A file that cannot be written.
pub fn write_run(folder: &Path, outcome: &Outcome) -> Result<(), OutputError> {
    create_folder(folder)?;
    let empty = Table::default();
    let trajectory = outcome.trajectory.as_ref().unwrap_or(&empty);
    let page = report::page(&outcome.summary, trajectory)?;
    write(&folder.join(TRAJECTORY_FILE), &trajectory.to_csv())?;
    write(&folder.join(SUMMARY_FILE), &summary_text(&outcome.summary))?;
    write(&folder.join(REPORT_FILE), &page)
}

/// Creates the folder and writes every file of a comparison into it.
///
/// # Errors
/// A file that cannot be written.
pub fn write_comparison(
    folder: &Path,
    comparison: &Comparison,
    curves: &[Curves],
) -> Result<(), OutputError> {
    create_folder(folder)?;
    let page = comparison::page(comparison, curves)?;
    // It holds finite numbers, strings and lists only, so it can always be written.
    let table = serde_json::to_string_pretty(comparison).unwrap_or_default() + "\n";
    write(&folder.join(COMPARISON_FILE), &table)?;
    write(&folder.join(COMPARISON_CSV), &comparison.to_csv())?;
    write(&folder.join(COMPARISON_PAGE), &page)
}

/// Creates a folder with those above it.
///
/// # Errors
/// A folder that cannot be created.
pub fn create_folder(folder: &Path) -> Result<(), OutputError> {
    std::fs::create_dir_all(folder).map_err(|source| OutputError::File {
        path: folder.to_path_buf(),
        problem: FileError::Io {
            action: "cannot be created",
            source,
        },
    })
}

/// A summary as one JSON object.
pub fn summary_text(summary: &Summary) -> String {
    // A summary holds finite numbers, strings and lists only, so it can always be written.
    serde_json::to_string_pretty(summary).unwrap_or_default() + "\n"
}

/// Builds the report again from a run's files.
///
/// # Errors
/// A file that is missing or not what it should be.
pub fn rebuild_report(folder: &Path) -> Result<String, OutputError> {
    let summary = read_summary(&folder.join(SUMMARY_FILE))?;
    let (_, trajectory) = read_trajectory(&folder.join(TRAJECTORY_FILE))?;
    Ok(report::page(&summary, &trajectory)?)
}

/// Reads a run's summary.
///
/// # Errors
/// A file that is missing or no summary.
pub fn read_summary(path: &Path) -> Result<Summary, OutputError> {
    let refuse = |reason| OutputError::Summary {
        path: path.to_path_buf(),
        reason,
    };
    let summary: Summary =
        serde_json::from_str(&read(path)?).map_err(|error| refuse(error.to_string()))?;
    if summary.schema_version != SUMMARY_SCHEMA_VERSION {
        return Err(refuse(format!(
            "schema_version is {}; this program reads {SUMMARY_SCHEMA_VERSION}",
            summary.schema_version
        )));
    }
    Ok(summary)
}

/// Largest trajectory that is read, bytes.
const LARGEST_TRAJECTORY: u64 = 1 << 30;

/// Reads a run's trajectory: its text and its table.
///
/// # Errors
/// A file that is missing or no table.
pub fn read_trajectory(path: &Path) -> Result<(String, Table), OutputError> {
    let text = read_text_up_to(path, LARGEST_TRAJECTORY).map_err(|problem| OutputError::File {
        path: path.to_path_buf(),
        problem,
    })?;
    let table = Table::from_csv(&text).map_err(|problem| OutputError::Table {
        path: path.to_path_buf(),
        problem,
    })?;
    Ok((text, table))
}

fn read(path: &Path) -> Result<String, OutputError> {
    read_text(path).map_err(|problem| OutputError::File {
        path: path.to_path_buf(),
        problem,
    })
}

/// Writes a file whole or not at all.
///
/// # Errors
/// A file that cannot be written.
pub fn write(path: &Path, text: &str) -> Result<(), OutputError> {
    write_atomically(path, text.as_bytes()).map_err(|problem| OutputError::File {
        path: path.to_path_buf(),
        problem,
    })
}
