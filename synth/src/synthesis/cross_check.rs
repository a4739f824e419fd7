//! The same optimum from two solvers.

use serde::Serialize;

use crate::design::ProblemUnits;
use crate::model::Model;
use crate::programs::{assemble, has_point, scaled_task, Asked, Goal, Solvers};
use sdp::solve::{Observer, SolveError};

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

/// The optima of the solvers for the same problem.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CrossCheck {
    /// Each solver's answer, in the order in which they were asked.
    pub found: Vec<SolverOptimum>,
    /// Distance of the first two gammas relative to the first; `None` when one is missing.
    pub relative_difference: Option<f64>,
}

/// Minimises gamma with each of the solvers, in its form of the problem, in the given units and with (18) at every
/// vertex. The model is one whose form of the gyroscopic torque has been chosen.
pub fn cross_check(
    model: &Model,
    units: &ProblemUnits,
    solvers: &Solvers,
    observer: Option<&Observer>,
) -> Result<CrossCheck, SolveError> {
    let (_, task) = scaled_task(model, units);
    let goal = Goal::SmallestGain;
    let smallest_gain = |(backend, form): Asked| {
        let problem = assemble(&task, form, goal).problem.lower();
        let solution = backend.solve(&problem, goal.accuracy(&task), observer.cloned())?;
        Ok(SolverOptimum {
            solver: backend.name(),
            gamma: has_point(&solution).then_some(solution.objective),
            status: solution.status_text,
            seconds: solution.seconds,
        })
    };
    let found = solvers.in_order().into_iter().map(smallest_gain);
    let found: Vec<SolverOptimum> = found.collect::<Result<_, _>>()?;
    let mut gammas = found.iter().map(|optimum| optimum.gamma);
    let both = gammas.next().flatten().zip(gammas.next().flatten());
    Ok(CrossCheck {
        relative_difference: both.map(|(a, b)| (a - b).abs() / a.abs()),
        found,
    })
}
