//! What the command line says when it cannot go on.

use std::path::{Path, PathBuf};

use synth::model::{FileError, ModelError};
use synth::solve::SolveError;
use synth::synthesis::SynthesisError;

use super::answer::Exit;
use crate::base::files::{what_was_written, OutputError};
use crate::batch::campaign::CampaignError;

/// One clear sentence; the exit status is 1.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// A file cannot be used, for a reason of its own.
    #[error("{}: {reason}", path.display())]
    Unsuitable {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// Scenarios cannot be compared.
    #[error("{0}")]
    Comparison(String),
    /// A campaign cannot go on.
    #[error("{0}")]
    Campaign(String),
    /// A file cannot be read or written, or is not what it should be.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A result with a page cannot be written.
    #[error(transparent)]
    Report(#[from] crate::report::pages::files::ReportError),
    /// An argument that is not what it should be.
    #[error("argument {argument}: {reason}")]
    Argument {
        /// The argument, such as --vary.
        argument: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// Synthesis could not run.
    #[error(transparent)]
    Synthesis(#[from] SynthesisError),
    /// Stopped by the user, with what is on the disk.
    #[error("interrupted; {}", what_was_written())]
    Interrupted,
    /// A sweep stopped by the user, its points kept.
    #[error(
        "interrupted; {done} of {points} points are done and kept in {}; the same command resumes there",
        folder.display()
    )]
    Resumable {
        /// Points that are kept.
        done: usize,
        /// All points.
        points: usize,
        /// Where they are.
        folder: PathBuf,
    },
    /// The points of a sweep cannot be kept or read.
    #[error(transparent)]
    Journal(#[from] crate::batch::store::journal::JournalError),
}

impl CliError {
    /// Exit status: 3 when the solver's point cannot be used, 1 otherwise.
    pub fn exit(&self) -> Exit {
        match self {
            CliError::Synthesis(SynthesisError::Invalid(_)) => Exit::SolverFailed,
            _ => Exit::Usage,
        }
    }

    /// A problem with a file.
    pub fn file(path: &Path, problem: impl Into<FileError>) -> Self {
        CliError::Output(OutputError::File {
            path: path.to_path_buf(),
            problem: problem.into(),
        })
    }

    /// A value of a file that is not allowed.
    pub fn value(path: &Path, problem: ModelError) -> Self {
        CliError::file(path, problem)
    }

    /// A file that is valid but not suitable here.
    pub fn unsuitable(path: &Path, reason: impl std::fmt::Display) -> Self {
        CliError::Unsuitable {
            path: path.to_path_buf(),
            reason: reason.to_string(),
        }
    }

    /// A campaign that cannot go on, with the file that it is about.
    pub fn campaign(scenario: &Path, problem: CampaignError) -> Self {
        let argument = |argument, reason: String| CliError::Argument { argument, reason };
        match problem {
            CampaignError::Scenario(problem) => CliError::file(scenario, problem),
            CampaignError::Shards(reason) => argument("--shard", reason),
            CampaignError::TooManyShards(error) => argument("--shard", error.to_string()),
            CampaignError::Output(_) | CampaignError::Unsuitable { .. } => {
                CliError::Campaign(problem.to_string())
            }
            other => CliError::unsuitable(scenario, other),
        }
    }

    /// A synthesis that could not run, with the file that it is about.
    pub fn synthesis(model: &Path, problem: SynthesisError) -> Self {
        match problem {
            SynthesisError::Cancelled(_) => CliError::Interrupted,
            // The numbers overflow on the way from the model to the solver.
            SynthesisError::Solve(problem @ SolveError::NotFinite { .. }) => {
                let reason = format!("{problem}; the model's numbers are too far apart");
                CliError::unsuitable(model, reason)
            }
            other => other.into(),
        }
    }
}
