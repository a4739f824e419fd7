//! The files of a run.

use std::path::Path;

use synth::model::read_text_up_to;

use super::summary::Summary;
use crate::base::files::{read, OutputError};
use crate::base::table::Table;
use crate::base::trajectory::check_trajectory;

/// Name of the trajectory's file.
pub const TRAJECTORY_FILE: &str = "trajectory.csv";
/// Name of the summary's file.
pub const SUMMARY_FILE: &str = "summary.json";
/// Name of the report's file.
pub const REPORT_FILE: &str = "report.html";

/// A summary as one JSON object.
pub fn summary_text(summary: &Summary) -> String {
    // A summary holds finite numbers, strings and lists only, so it can always be written.
    serde_json::to_string_pretty(summary).unwrap_or_default() + "\n"
}

/// Reads a run's summary.
///
/// # Errors
/// A file that is missing or no summary.
pub fn read_summary(path: &Path) -> Result<Summary, OutputError> {
    Summary::from_json(&read(path)?).map_err(|problem| OutputError::Summary {
        path: path.to_path_buf(),
        problem,
    })
}

/// Largest trajectory that is read, bytes.
const LARGEST_TRAJECTORY: u64 = 1 << 30;

/// Reads a run's trajectory: its text and its table.
///
/// # Errors
/// A file that is missing or no trajectory.
pub fn read_trajectory(path: &Path) -> Result<(String, Table), OutputError> {
    let text = read_text_up_to(path, LARGEST_TRAJECTORY).map_err(|problem| OutputError::File {
        path: path.to_path_buf(),
        problem,
    })?;
    let table = Table::from_csv(&text).map_err(|problem| OutputError::Table {
        path: path.to_path_buf(),
        problem,
    })?;
    check_trajectory(&table).map_err(|problem| OutputError::Trajectory {
        path: path.to_path_buf(),
        problem,
    })?;
    Ok((text, table))
}
