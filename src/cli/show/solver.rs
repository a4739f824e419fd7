//! The work of the solvers.

use serde::Serialize;
use synth::design::SolverRun;

use crate::cli::answer::Exit;

/// What a synthesis or an analysis came to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SolverStatus {
    /// A candidate was found; its verdict says whether it is proved.
    Solved,
    /// There is none: proved.
    Infeasible,
    /// None was found, and none was proved not to exist.
    Undecided,
    /// The solvers failed numerically.
    Failed,
}

impl SolverStatus {
    /// The exit status where nothing was found.
    pub fn exit_without_design(self) -> Exit {
        match self {
            SolverStatus::Failed => Exit::SolverFailed,
            _ => Exit::No,
        }
    }
}

/// What the solvers did.
#[derive(Debug, Serialize)]
pub struct SolverReport<'a> {
    /// What it came to.
    pub status: SolverStatus,
    /// Time in solvers (s).
    pub solve_seconds: f64,
    /// Each run; its status is the solver's and proves nothing.
    pub solver_runs: &'a [SolverRun],
}

impl SolverReport<'_> {
    /// One line for each run.
    pub fn lines(&self) -> impl Iterator<Item = String> + '_ {
        self.solver_runs.iter().map(|run| {
            format!(
                "solver: {}, {} at {} vertices: {} after {} iterations, {:.2} s (its own opinion)",
                run.solver, run.goal, run.vertices, run.status, run.iterations, run.seconds
            )
        })
    }
}
