//! What a solver is given and what it returns.

use std::sync::Arc;

use crate::lmi::{Cone, Semidefinite};

/// Solver status, unverified.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Converged to full accuracy.
    Solved,
    /// Converged to reduced accuracy.
    Inaccurate,
    /// Claims that no point satisfies the conditions.
    Infeasible,
    /// Claims that the objective has no lower bound.
    Unbounded,
    /// Gave up: iteration or time limit, no progress, numerical error.
    Failed,
    /// Stopped by the progress observer.
    Cancelled,
}

/// What a solver reports between iterations.
#[derive(Debug, Clone, Copy)]
pub struct Progress {
    /// Iterations so far.
    pub iteration: u32,
    /// Primal objective.
    pub objective: f64,
    /// Relative duality gap.
    pub relative_gap: f64,
}

/// Called between iterations; `false` stops the solver.
pub type Observer = Arc<dyn Fn(&Progress) -> bool + Send + Sync>;

/// A candidate solution.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Solver status, unverified.
    pub status: Status,
    /// The status as the solver names it.
    pub status_text: String,
    /// Values of the scalar unknowns.
    pub values: Vec<f64>,
    /// Dual matrix of each cone, as its full upper triangle stacked by columns
    /// ([`svec_index`](crate::lmi::svec_index) order, plain entries without sqrt(2)).
    pub duals: Vec<Vec<f64>>,
    /// Objective, including its constant part.
    pub objective: f64,
    /// Iterations done.
    pub iterations: u32,
    /// Wall time (s).
    pub seconds: f64,
}

/// Why a solver could not even start.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SolveError {
    /// The backend refused the problem.
    #[error("{backend} refused the problem: {reason}")]
    Refused {
        /// Name of the backend.
        backend: &'static str,
        /// Its message.
        reason: String,
    },
    /// There is not enough memory.
    #[error(
        "{backend} needs {} for this problem, whose widest cone has side {widest}, and {} ({available} bytes) are free",
        need(*needed),
        bytes(*available)
    )]
    Memory {
        /// Name of the backend.
        backend: &'static str,
        /// Estimate of what it needs (bytes).
        needed: u64,
        /// What is free (bytes).
        available: u64,
        /// Side of the widest cone.
        widest: usize,
    },
    /// A number of the problem is not finite.
    #[error("the problem given to {backend} holds a number that is not finite, in condition '{condition}'")]
    NotFinite {
        /// Name of the backend.
        backend: &'static str,
        /// Name of the condition.
        condition: String,
    },
}

/// A need of memory in words. An estimate that no number of 64 bits holds is the largest one.
fn need(count: u64) -> String {
    match count {
        u64::MAX => "more memory than any machine has".to_string(),
        count => format!("about {} ({count} bytes)", bytes(count)),
    }
}

/// Bytes in words: three digits and a unit of 1000.
pub(crate) fn bytes(count: u64) -> String {
    let units = ["bytes", "kB", "MB", "GB", "TB", "PB", "EB"];
    let mut size = count as f64;
    let mut unit = 0;
    while size >= 999.5 && unit + 1 < units.len() {
        size /= 1000.0;
        unit += 1;
    }
    let digits = match size {
        _ if unit == 0 => 0,
        size if size < 9.995 => 2,
        size if size < 99.95 => 1,
        _ => 0,
    };
    format!("{size:.digits$} {}", units[unit])
}

/// When a solver may stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// Duality gap relative to the objective, or to `objective_unit` where that is larger.
    pub relative_gap: f64,
    /// A size that the objective is expected to have or exceed; above 0.
    pub objective_unit: f64,
}

/// The two solvers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solver {
    /// The `clarabel` crate.
    Clarabel,
    /// The solver for few unknowns and many small cones.
    Structured,
}

/// A semidefinite programming solver.
pub trait Backend {
    /// Name and version, for the provenance of a design.
    fn name(&self) -> String;

    /// Vertices of a model that are put to this solver at once; of more, only those that matter.
    fn vertices_at_once(&self) -> usize {
        24
    }

    /// Which of the two solvers this is; `None` for any other.
    fn solver(&self) -> Option<Solver> {
        None
    }

    /// Minimises the objective of `problem` to the requested accuracy; the observer is called between
    /// iterations.
    fn solve(
        &self,
        problem: &Semidefinite,
        accuracy: Accuracy,
        observer: Option<Observer>,
    ) -> Result<Solution, SolveError>;
}

/// Refuses a problem with a number that is not finite.
pub(crate) fn check_finite(
    backend: &'static str,
    problem: &Semidefinite,
) -> Result<(), SolveError> {
    let finite = |cone: &Cone| {
        let coefficients = cone.coefficients.iter().flat_map(|(_, entries)| entries);
        cone.constant
            .iter()
            .chain(coefficients)
            .all(|entry| entry.value.is_finite())
    };
    let mut objective = problem.cost.iter().chain([&problem.offset]);
    let condition = match objective.all(|number| number.is_finite()) {
        false => Some("objective"),
        true => problem
            .cones
            .iter()
            .find(|cone| !finite(cone))
            .map(|cone| cone.name.as_str()),
    };
    condition.map_or(Ok(()), |condition| {
        Err(SolveError::NotFinite {
            backend,
            condition: condition.to_string(),
        })
    })
}
