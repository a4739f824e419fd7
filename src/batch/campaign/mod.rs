//! Campaigns: many runs of one scenario with numbers sampled for each, streamed to tables.
//!
//! The runs of a [`plan`] are numbered. What a run draws depends on the campaign's seed and the run's
//! number only, so any run can be made alone, and neither the number of threads nor interruptions nor
//! the division into shards changes the result.

mod dispersion;
pub mod finish;
pub mod folder;
pub mod job;
pub mod merge;
pub mod plan;
pub mod record;
pub mod row;
pub mod statistics;
pub mod table;

use std::path::{Path, PathBuf};

use synth::model::{FileError, ModelError};

use super::engine::Interrupted;
use super::store::chunks::TooManyShards;
use super::variation::samples::TooManyNumbers;
use crate::base::files::OutputError;
use crate::run::outcome::SimulateError;

/// Why a campaign cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum CampaignError {
    /// A file cannot be read or written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The scenario file is not valid.
    #[error(transparent)]
    Scenario(#[from] FileError),
    /// A file is not what it should be.
    #[error("{}: {reason}", path.display())]
    Unsuitable {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A run cannot be made.
    #[error("run {run}: {reason}")]
    Run {
        /// Its index.
        run: u64,
        /// Why.
        reason: String,
    },
    /// The design does not fit.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The table's library refuses something.
    #[error("the table of the runs: {0}")]
    Table(String),
    /// More numbers are drawn than there are directions for.
    #[error(transparent)]
    TooManyNumbers(#[from] TooManyNumbers),
    /// Shards that do not make a campaign.
    #[error("{0}")]
    Shards(String),
    /// More shards than there is work for.
    #[error(transparent)]
    TooManyShards(#[from] TooManyShards),
    /// It was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl CampaignError {
    fn broken(path: &Path, error: impl std::fmt::Display) -> Self {
        Self::unsuitable(path, format!("is not a table that can be read: {error}"))
    }

    fn unsuitable(path: &Path, reason: String) -> Self {
        let path = path.to_path_buf();
        CampaignError::Unsuitable { path, reason }
    }
}

impl From<ModelError> for CampaignError {
    fn from(error: ModelError) -> Self {
        CampaignError::Scenario(error.into())
    }
}
