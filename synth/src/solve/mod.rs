//! Solvers for semidefinite programs, behind one trait.
//!
//! What a solver returns is a candidate. Its status is reported to the user and trusted nowhere:
//! whether a design is proved is decided by [`certify`](crate::certify) from the exported numbers.

mod alternative;
mod backend;
mod clarabel;
pub mod lapack;
mod residuals;
mod structured;

pub use alternative::alternative;
pub use backend::{Accuracy, Backend, Observer, Progress, Solution, SolveError, Solver, Status};
pub use clarabel::{Clarabel, Padding};
pub use residuals::{residuals, Residuals};
pub use structured::{Structured, Timings};
