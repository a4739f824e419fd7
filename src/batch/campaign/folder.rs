//! What is where in a campaign's folder.

use std::path::{Path, PathBuf};

/// What was requested and what came of it.
pub const CAMPAIGN_FILE: &str = "campaign.json";
/// One row for each run.
pub const RUNS_FILE: &str = "runs.parquet";
/// The error of every run on a grid of times.
pub const PROFILES_FILE: &str = "profiles.parquet";
/// The campaign's scenario, byte for byte.
pub const SCENARIO_FILE: &str = "scenario.json";
/// The design, byte for byte, where the scenario has one.
pub const DESIGN_FILE: &str = "design.json";
/// The failed runs that are kept.
pub const FAILED_FOLDER: &str = "failed";
/// What is done of a campaign that is not complete.
pub const PARTS_FOLDER: &str = "parts";

/// Name of the folder of a run that is kept, such as `run-000042`.
pub fn run_folder_name(run: u64) -> String {
    format!("run-{run:06}")
}

/// Folder of a run that is kept.
pub fn run_folder(campaign: &Path, run: u64) -> PathBuf {
    campaign.join(FAILED_FOLDER).join(run_folder_name(run))
}

/// File of a part.
pub(crate) fn part_file(campaign: &Path, part: u64) -> PathBuf {
    campaign
        .join(PARTS_FOLDER)
        .join(format!("part-{part:06}.parquet"))
}
