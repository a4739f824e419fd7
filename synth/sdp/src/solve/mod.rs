//! Solvers for semidefinite programs, behind one trait.
//!
//! What a solver returns is a candidate. Its status is reported to the user and trusted nowhere:
//! what is proved is decided elsewhere, from the exported numbers.

mod alternative;
mod clarabel;
pub mod lapack;
mod residuals;
mod structured;

pub use crate::backend::{
    Accuracy, Backend, Observer, Progress, Solution, SolveError, Solver, Status,
};
pub use alternative::alternative;
pub use clarabel::{Clarabel, DenseColumns};
pub use residuals::{residuals, Residuals};
pub use structured::{Structured, Timings};
