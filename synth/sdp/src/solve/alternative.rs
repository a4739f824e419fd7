//! The solver that is tried where the first finds no design.

use super::clarabel::Clarabel;
use super::structured::Structured;
use crate::backend::{Backend, Solver};

/// The other of the two solvers, with its usual settings; `None` for a solver that is neither.
///
/// A solver's "infeasible" or "failed" is no verdict: the other one often solves the same problem.
pub fn alternative(backend: &dyn Backend) -> Option<Box<dyn Backend>> {
    match backend.solver()? {
        Solver::Clarabel => Some(Box::new(Structured::default())),
        Solver::Structured => Some(Box::new(Clarabel::default())),
    }
}
