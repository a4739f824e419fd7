//! Solvers for semidefinite programs, behind one trait.
//!
//! What a solver returns is a candidate. Its status is reported to the user and trusted nowhere:
//! what is proved is decided elsewhere, from the exported numbers.

mod attempts;
mod certificates;
mod clarabel;
pub mod lapack;
mod outcome;
mod residuals;
mod structured;

pub use crate::backend::{
    Accuracy, Backend, Observer, Progress, Solution, SolveError, Solver, Status,
};
pub use attempts::{attempts, best, Attempt, Found};
pub use certificates::{Descent, Refutation};
pub use clarabel::{Clarabel, DenseColumns};
pub use outcome::{Judgement, Limits, Outcome, INACCURATE, SOLVED};
pub use residuals::{residuals, Residuals};
pub use structured::{Structured, Timings};

/// The other of the two solvers, with its usual settings; `None` for a solver that is neither.
///
/// A solver's "infeasible" or "failed" is no verdict: the other one often solves the same problem.
pub fn alternative(backend: &dyn Backend) -> Option<Box<dyn Backend>> {
    match backend.solver()? {
        Solver::Clarabel => Some(Box::new(Structured::default())),
        Solver::Structured => Some(Box::new(Clarabel::default())),
    }
}
