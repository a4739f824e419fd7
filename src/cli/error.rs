//! What the command line says when it cannot go on.

use std::path::{Path, PathBuf};

use synth::model::{FileError, ModelError};
use synth::solve::SolveError;
use synth::synthesis::SynthesisError;

use crate::batch::campaign::plan::PlanError;
use crate::batch::campaign::CampaignError;

/// One clear sentence; the exit status is 1.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// A file cannot be used.
    #[error("{}: {problem}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: FileError,
    },
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
    /// A result cannot be written.
    #[error(transparent)]
    Output(#[from] crate::base::files::OutputError),
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
    Synthesis(#[from] synth::synthesis::SynthesisError),
    /// Stopped by the user.
    #[error("interrupted; nothing was written")]
    Interrupted,
    /// A sweep stopped by the user, its points kept.
    #[error(
        "interrupted; {done} of {points} points are done and kept in {}; the same command goes on from there",
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
    pub fn exit_status(&self) -> u8 {
        match self {
            CliError::Synthesis(synth::synthesis::SynthesisError::Invalid(_)) => {
                super::answer::EXIT_SOLVER
            }
            _ => 1,
        }
    }

    /// A problem with a file.
    pub fn file(path: &Path, problem: impl Into<FileError>) -> Self {
        CliError::File {
            path: path.to_path_buf(),
            problem: problem.into(),
        }
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
}

/// A file that has no plan.
pub(crate) fn unplanned(scenario: &Path, error: PlanError) -> CliError {
    match error {
        PlanError::File(problem) => CliError::file(scenario, problem),
        PlanError::Campaign(error) => told(scenario, error),
    }
}

/// What is wrong, with the file that it is about.
pub(crate) fn told(scenario: &Path, error: CampaignError) -> CliError {
    let argument = |argument, reason: String| CliError::Argument { argument, reason };
    match error {
        CampaignError::Shards(reason) => argument("--shard", reason),
        CampaignError::TooManyShards(error) => argument("--shard", error.to_string()),
        CampaignError::Output(_) | CampaignError::Unsuitable { .. } => {
            CliError::Campaign(error.to_string())
        }
        error => CliError::unsuitable(scenario, error),
    }
}

/// What a search that could not run means to the user.
pub fn solver_problem(model: &Path, error: SynthesisError) -> CliError {
    match error {
        SynthesisError::Cancelled(_) => CliError::Interrupted,
        // The numbers overflow on the way from the model to the solver.
        SynthesisError::Solve(problem @ SolveError::NotFinite { .. }) => {
            let reason = format!("{problem}; the model's numbers are too far apart");
            CliError::unsuitable(model, reason)
        }
        other => other.into(),
    }
}
