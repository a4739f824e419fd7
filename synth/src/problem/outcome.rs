//! What the synthesis of a design problem may come to.

use super::design::ProblemDesignFile;
use super::exclusion::Excluded;
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
    /// The guarantee beside the best one that a solver reported.
    pub optimality: Option<Optimality>,
}

/// Why there is no feedback.
#[derive(Debug, Clone)]
pub struct ProblemFailure {
    /// The smallest slack with which all conditions hold, in scaled units, where the solver found it.
    pub slack: Option<f64>,
    /// What is proved about solutions that there are not; [`Excluded::conclusive`] says whether that is all of them.
    pub excluded: Option<Excluded>,
    /// The conditions with the largest share of the dual solution: those that block.
    pub blocking: Vec<(String, f64)>,
    /// Time spent in solvers (s).
    pub solve_seconds: f64,
    /// The solver's runs.
    pub runs: Vec<SolverRun>,
}

/// What synthesis found.
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
