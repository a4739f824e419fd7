//! The same optimum from two solvers.

use serde::Serialize;

use crate::design::ProblemUnits;
use crate::model::Model;
use crate::programs::{assemble, scaled_task, Form, Goal};
use sdp::solve::{Backend, Observer, SolveError, Status};

/// A solver and the form of the problem it is given.
#[derive(Clone, Copy)]
pub struct Candidate<'a> {
    /// The solver.
    pub backend: &'a dyn Backend,
    /// The form.
    pub form: Form,
}

/// One solver's smallest gain bound.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SolverOptimum {
    /// Name and version.
    pub solver: String,
    /// The solver's status, unverified.
    pub status: String,
    /// gamma; `None` when it found none.
    pub gamma: Option<f64>,
    /// Wall time (s).
    pub seconds: f64,
}

/// The optima of two solvers for the same problem.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CrossCheck {
    /// Each solver's answer.
    pub found: [SolverOptimum; 2],
    /// Distance of the gammas relative to the first; `None` when one is missing.
    pub relative_difference: Option<f64>,
}

/// Minimises gamma with both solvers, in the given units and with (18) at every vertex.
pub fn cross_check(
    model: &Model,
    units: ProblemUnits,
    candidates: [Candidate<'_>; 2],
    observer: Option<&Observer>,
) -> Result<CrossCheck, SolveError> {
    let [first, second] = candidates;
    let found = [
        smallest_gain(model, units, first, observer)?,
        smallest_gain(model, units, second, observer)?,
    ];
    let both = found[0].gamma.zip(found[1].gamma);
    Ok(CrossCheck {
        relative_difference: both.map(|(a, b)| (a - b).abs() / a.abs()),
        found,
    })
}

fn smallest_gain(
    model: &Model,
    units: ProblemUnits,
    candidate: Candidate<'_>,
    observer: Option<&Observer>,
) -> Result<SolverOptimum, SolveError> {
    let (_, task) = scaled_task(model, units);
    let goal = Goal::SmallestGain;
    let problem = assemble(&task, candidate.form, goal).problem.lower();
    let backend = candidate.backend;
    let solution = backend.solve(&problem, goal.accuracy(&task), observer.cloned())?;
    let usable = matches!(solution.status, Status::Solved | Status::Inaccurate);
    Ok(SolverOptimum {
        solver: backend.name(),
        status: solution.status_text,
        gamma: usable.then_some(solution.objective),
        seconds: solution.seconds,
    })
}
