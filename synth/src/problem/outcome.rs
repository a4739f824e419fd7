//! The outcomes of the synthesis of a design problem.

use super::design::ProblemDesignFile;
use super::exclusion::InfeasibilityProof;
use crate::certify::Report;
use crate::design::SolverRun;
use crate::optimality::Optimality;

/// A feedback and how it was found.
#[derive(Debug, Clone)]
pub struct ProblemSynthesized {
    /// The file, with its verdict.
    pub file: ProblemDesignFile,
    /// The check of the file's numbers.
    pub report: Report,
    /// Time spent in solvers (s).
    pub solve_seconds: f64,
    /// The guarantee with the best one that a solver reported, which is not proved.
    pub optimality: Option<Optimality>,
}

/// Why there is no feedback.
#[derive(Debug, Clone)]
pub struct ProblemFailure {
    /// The smallest slack with which all conditions hold, in scaled units, where the solver found it.
    pub slack: Option<f64>,
    /// The proof that there is no solution; [`InfeasibilityProof::conclusive`] says whether it needs no bound that matters.
    pub infeasibility: Option<InfeasibilityProof>,
    /// The conditions with the largest fractions of the dual solution's trace: those that block.
    pub blocking: Vec<(String, f64)>,
    /// Time spent in solvers (s).
    pub solve_seconds: f64,
    /// The solver's runs.
    pub runs: Vec<SolverRun>,
}

/// The outcome of a synthesis.
#[derive(Debug, Clone)]
pub enum ProblemOutcome {
    /// A feedback; its report says whether it is proved.
    Solved(Box<ProblemSynthesized>),
    /// There is none: proved.
    Infeasible(ProblemFailure),
    /// Neither a feedback nor its impossibility is proved.
    Undecided(ProblemFailure),
    /// The solvers gave up.
    SolverFailed(ProblemFailure),
}
