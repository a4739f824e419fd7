//! `steadfast report DIR`

use std::path::PathBuf;
use std::process::ExitCode;

use super::{print, CliError};
use crate::harness::output::{rebuild_report, write, REPORT_FILE};

/// Arguments of `report`.
#[derive(clap::Args)]
pub struct ReportArgs {
    /// Folder written by `simulate -o`
    folder: PathBuf,
    /// The page; report.html in the folder when left out
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Builds the report page again from a run's files.
pub fn run(args: &ReportArgs) -> Result<ExitCode, CliError> {
    let unsuitable = |error| CliError::unsuitable(&args.folder, error);
    let page = rebuild_report(&args.folder).map_err(unsuitable)?;
    let default = args.folder.join(REPORT_FILE);
    let path = args.output.as_ref().unwrap_or(&default);
    write(path, &page).map_err(unsuitable)?;
    print(&format!("written: {}", path.display()));
    Ok(ExitCode::SUCCESS)
}
