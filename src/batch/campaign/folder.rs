//! What is where in a campaign's folder.

use std::fs::File;
use std::path::{Path, PathBuf};

use synth::model::is_temporary;

pub use super::record::CAMPAIGN_FILE;
use super::record::{CampaignFile, Inputs, State};
use super::table::CampaignColumns;
use super::CampaignError;
use crate::base::files::{create_folder, write};
use crate::batch::store::lock::{lock_folder, InUse};

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

/// What the name of a part begins and ends with; between them is its number.
const PART_NAME: (&str, &str) = ("part-", ".parquet");
/// What the name of the folder of a run that is kept begins with.
const RUN_NAME: &str = "run-";
/// Digits of a number in a name, at least.
const DIGITS: usize = 6;

/// Whether a name in the folder of parts is that of a part, or of one that was begun when the process was killed.
pub fn is_part(name: &str) -> bool {
    let (begin, end) = PART_NAME;
    let number = name
        .strip_prefix(begin)
        .and_then(|rest| rest.strip_suffix(end));
    is_temporary(name) || number.is_some_and(is_number)
}

/// Whether a name in the folder of kept runs is that of a run.
pub fn is_kept_run(name: &str) -> bool {
    name.strip_prefix(RUN_NAME).is_some_and(is_number)
}

fn is_number(text: &str) -> bool {
    text.len() >= DIGITS && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// Name of the folder of a run that is kept, such as `run-000042`.
pub fn run_folder_name(run: u64) -> String {
    format!("{RUN_NAME}{run:0DIGITS$}")
}

/// Folder of a run that is kept.
pub fn run_folder(campaign: &Path, run: u64) -> PathBuf {
    campaign.join(FAILED_FOLDER).join(run_folder_name(run))
}

/// A campaign, or a shard of it, and its folder.
#[derive(Debug, Clone)]
pub struct CampaignFolder {
    /// The folder.
    pub path: PathBuf,
    /// Columns of the tables.
    pub columns: CampaignColumns,
    /// What determines every number.
    pub inputs: Inputs,
}

/// A campaign's folder, which nobody else can write to as long as this is there.
pub struct OpenFolder {
    /// How far the campaign is in it.
    pub state: State,
    _lock: Option<File>,
}

impl CampaignFolder {
    /// How far the campaign is in the folder; `None` when there is nothing of it.
    ///
    /// # Errors
    /// A folder that holds another campaign.
    pub fn found(&self) -> Result<Option<State>, CampaignError> {
        if !self.path.join(CAMPAIGN_FILE).exists() {
            return Ok(None);
        }
        let known = CampaignFile::read(&self.path)?;
        match known.inputs.difference(&self.inputs) {
            None => Ok(Some(known.state)),
            Some(difference) => {
                let reason = format!("holds another campaign: {difference}; choose another folder");
                Err(CampaignError::unsuitable(&self.path, reason))
            }
        }
    }

    /// Creates the folder with its record, or says how far the same campaign is in it.
    ///
    /// # Errors
    /// A folder that cannot be written, that is in use or that holds another campaign.
    pub fn open(&self, scenario: &str, design: Option<&str>) -> Result<OpenFolder, CampaignError> {
        create_folder(&self.path)?;
        let lock = lock_folder(&self.path).map_err(|InUse| {
            CampaignError::unsuitable(&self.path, "is in use by another campaign".to_string())
        })?;
        let state = match self.found()? {
            Some(state) => state,
            None => {
                write(&self.path.join(SCENARIO_FILE), scenario)?;
                if let Some(design) = design {
                    write(&self.path.join(DESIGN_FILE), design)?;
                }
                CampaignFile::write(&self.path, &self.inputs, None)?;
                State::Running
            }
        };
        Ok(OpenFolder { state, _lock: lock })
    }

    /// File of a part.
    pub(super) fn part(&self, part: u64) -> PathBuf {
        let parts = self.path.join(PARTS_FOLDER);
        let (begin, end) = PART_NAME;
        parts.join(format!("{begin}{part:0DIGITS$}{end}"))
    }
}
