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
