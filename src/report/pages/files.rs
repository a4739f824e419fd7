//! The files of a run, of a comparison and of a sweep, with their pages.

use std::path::Path;

use super::{comparison, run, sweep};
use crate::base::files::{create_folder, write, OutputError};
use crate::base::parquet;
use crate::base::table::Table;
use crate::batch::campaign::CampaignError;
use crate::batch::comparison::{Comparison, Curves};
use crate::batch::sweep::finished::{Finished, CSV_FILE, PAGE_FILE, PARQUET_FILE, PROVENANCE_FILE};
use crate::batch::sweep::table;
use crate::report::chart::FigureError;
use crate::run::files::{
    read_summary, read_trajectory, summary_text, REPORT_FILE, SUMMARY_FILE, TRAJECTORY_FILE,
};
use crate::run::outcome::RunOutcome;

/// Name of a comparison's table.
pub const COMPARISON_FILE: &str = "comparison.json";
/// Name of a comparison's table as comma-separated values.
pub const COMPARISON_CSV: &str = "comparison.csv";
/// Name of a comparison's page.
pub const COMPARISON_PAGE: &str = "comparison.html";

/// Why results with a page cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A file cannot be read or written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A figure cannot be drawn.
    #[error("the report's figures cannot be drawn: {0}")]
    Figure(#[from] FigureError),
    /// The files of a campaign.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// A campaign that is still running.
    #[error(
        "the campaign is not complete; the same `campaign` command goes on where it stopped, and then \
         there is a report"
    )]
    Running,
}

/// Creates the folder and writes every file of a run into it, each under a temporary name first.
///
/// # Errors
/// A file that cannot be written.
pub fn write_run(folder: &Path, outcome: &RunOutcome) -> Result<(), ReportError> {
    create_folder(folder)?;
    let empty = Table::default();
    let trajectory = outcome.trajectory.as_ref().unwrap_or(&empty);
    let page = run::page(&outcome.summary, trajectory)?;
    write(&folder.join(TRAJECTORY_FILE), &trajectory.to_csv())?;
    write(&folder.join(SUMMARY_FILE), &summary_text(&outcome.summary))?;
    Ok(write(&folder.join(REPORT_FILE), &page)?)
}

/// Creates the folder and writes every file of a comparison into it.
///
/// # Errors
/// A file that cannot be written.
pub fn write_comparison(
    folder: &Path,
    comparison: &Comparison,
    curves: &[Curves],
) -> Result<(), ReportError> {
    create_folder(folder)?;
    let page = comparison::page(comparison, curves)?;
    // It holds finite numbers, strings and lists only, so it can always be written.
    let table = serde_json::to_string_pretty(comparison).unwrap_or_default() + "\n";
    write(&folder.join(COMPARISON_FILE), &table)?;
    write(&folder.join(COMPARISON_CSV), &comparison.to_csv())?;
    Ok(write(&folder.join(COMPARISON_PAGE), &page)?)
}

/// Builds the report again from a run's files.
///
/// # Errors
/// A file that is missing or not what it should be.
pub fn rebuild_report(folder: &Path) -> Result<String, ReportError> {
    let summary = read_summary(&folder.join(SUMMARY_FILE))?;
    let (_, trajectory) = read_trajectory(&folder.join(TRAJECTORY_FILE))?;
    Ok(run::page(&summary, &trajectory)?)
}

/// Writes a sweep's table, page and provenance, each whole or not at all. Nothing in them depends on the
/// clock, on the number of threads, or on how often the sweep was ended.
///
/// # Errors
/// A file that cannot be written; a figure that cannot be drawn.
pub fn write_sweep(folder: &Path, sweep: &Finished) -> Result<(), ReportError> {
    let columns = table::columns(sweep.subject, sweep.grid, sweep.outcomes);
    let path = folder.join(CSV_FILE);
    let csv = parquet::to_csv(&columns).map_err(|error| OutputError::unmade(&path, error))?;
    write(&path, &csv)?;
    parquet::write_table(&folder.join(PARQUET_FILE), &columns, &sweep.about())?;
    write(&folder.join(PAGE_FILE), &sweep::page(sweep)?)?;
    Ok(write(&folder.join(PROVENANCE_FILE), &sweep.provenance())?)
}
