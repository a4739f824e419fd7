//! `campaign.json`: what was requested and what came of it.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::CampaignError;
use crate::base::files::{read, write, OutputError};
use crate::batch::store::chunks::Shard;
use crate::batch::store::identity::first_difference;
use crate::scenario::PlanFile;

/// What was requested and what came of it.
pub const CAMPAIGN_FILE: &str = "campaign.json";
/// The version of the format of `campaign.json`.
pub const CAMPAIGN_SCHEMA_VERSION: u32 = 1;

/// `campaign.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CampaignFile {
    /// Version of this format: 1.
    pub schema_version: u32,
    /// Whether every run is done.
    pub state: State,
    /// What determines every number in the folder.
    pub inputs: Inputs,
    /// What came of it; null while running.
    pub results: Option<Results>,
}

/// Whether every run is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// Some runs are not.
    Running,
    /// Every file is there.
    Complete,
}

/// What determines every number of a campaign. The same object is in the metadata of its tables.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Inputs {
    /// Program and version.
    pub generator: String,
    /// Name of the scenario.
    pub scenario: String,
    /// SHA-256 of the scenario file.
    pub scenario_sha256: String,
    /// SHA-256 of the design file.
    pub design_sha256: Option<String>,
    /// Seed of the campaign.
    pub seed: u64,
    /// Runs of the whole campaign, all shards.
    pub runs: u64,
    /// How the drawn numbers are spread.
    pub sampling: PlanFile,
    /// The part of the campaign that this folder holds; null for all of it.
    pub shard: Option<Shard>,
    /// First run of this folder.
    pub first_run: u64,
    /// The run after the last of this folder.
    pub end_run: u64,
}

/// What came of a campaign.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Results {
    /// Runs in this folder.
    pub runs: u64,
    /// Runs whose verdict is not `requirements_met`.
    pub failures: u64,
    /// Runs of each verdict.
    pub verdicts: BTreeMap<String, u64>,
    /// Runs that the design's proof covers; null without a design.
    pub covered_runs: Option<u64>,
    /// Fraction of the runs that met every requirement.
    pub pass_rate: f64,
    /// How well the pass rate is known.
    pub pass_rate_interval: PassRateInterval,
    /// The requirements.
    pub requirements: Vec<RequirementCount>,
    /// Metrics that at least one run has, by name.
    pub metrics: BTreeMap<String, Quantiles>,
    /// What `profiles.parquet` holds.
    pub profile: ProfileGrid,
    /// Failed runs that are kept with their trajectory, the worst first.
    pub kept: Vec<u64>,
    /// Failed runs that are not; each can be run again from its index.
    pub not_kept: u64,
}

/// A confidence interval.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PassRateInterval {
    /// Its level.
    pub confidence: f64,
    /// Lower end.
    pub lower: f64,
    /// Upper end.
    pub upper: f64,
    /// How it is computed.
    pub method: String,
}

/// How many runs missed a requirement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RequirementCount {
    /// The metric and the side of the limit.
    pub name: String,
    /// The metric.
    pub metric: String,
    /// The limit.
    pub limit: f64,
    /// Runs that missed it.
    pub missed: u64,
}

/// How a metric is spread over the runs that have it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quantiles {
    /// Runs that have it.
    pub count: u64,
    /// Smallest.
    pub min: f64,
    /// Median.
    pub median: f64,
    /// 95th percentile.
    pub p95: f64,
    /// Largest.
    pub max: f64,
}

/// What is recorded of every run along time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProfileGrid {
    /// Times, s.
    pub times_s: Vec<f64>,
    /// Names of the columns without the number of the time.
    pub quantities: Vec<String>,
}

impl Inputs {
    /// As they are in the tables' metadata. They hold numbers and texts only, so they can always be written.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }

    /// The first input that differs, as text.
    pub fn difference(&self, requested: &Self) -> Option<String> {
        let differs = first_difference(self, requested, &IDENTITY)?;
        Some(format!(
            "its {} is {}, not {}",
            differs.key, differs.known, differs.requested
        ))
    }
}

/// The inputs, those that explain a difference best first.
const IDENTITY: [&str; 10] = [
    "scenario_sha256",
    "design_sha256",
    "seed",
    "runs",
    "shard",
    "sampling",
    "generator",
    "scenario",
    "first_run",
    "end_run",
];

impl CampaignFile {
    /// Reads a folder's record.
    ///
    /// # Errors
    /// A folder without a record, or with one that is not valid.
    pub fn read(folder: &Path) -> Result<Self, CampaignError> {
        let path = folder.join(CAMPAIGN_FILE);
        let text = read(&path)?;
        let bad = |reason| {
            CampaignError::unsuitable(&path, format!("not the record of a campaign: {reason}"))
        };
        let file: Self = serde_json::from_str(&text).map_err(|error| bad(error.to_string()))?;
        if file.schema_version != CAMPAIGN_SCHEMA_VERSION {
            return Err(bad(format!(
                "schema_version is {}; this program reads {CAMPAIGN_SCHEMA_VERSION}",
                file.schema_version
            )));
        }
        Ok(file)
    }

    /// Writes the record of a folder: its inputs, and what came of it where it is complete.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(
        folder: &Path,
        inputs: &Inputs,
        results: Option<&Results>,
    ) -> Result<(), OutputError> {
        let record = CampaignFile {
            schema_version: CAMPAIGN_SCHEMA_VERSION,
            state: results.map_or(State::Running, |_| State::Complete),
            inputs: inputs.clone(),
            results: results.cloned(),
        };
        // It holds finite numbers, strings and lists only, so it can always be written.
        let text = serde_json::to_string_pretty(&record).unwrap_or_default() + "\n";
        write(&folder.join(CAMPAIGN_FILE), &text)
    }
}
