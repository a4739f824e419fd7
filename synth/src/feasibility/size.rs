//! The designs that an infeasibility certificate does not cover. Where its proof bounds the multiplier, solvers
//! show how large the multiplier's entries become.

use nalgebra::DMatrix;

use crate::certify::infeasible::{limits, Limit, Refutation};
use crate::conditions::{GainPlan, Task};
use crate::infeasibility::InfeasibilityFile;
use crate::model::Model;
use crate::programs::{
    largest_magnitude, scaled, Goal, Session, Solvers, SynthesisError, FIRST_UNITS,
};
use sdp::solve::Solver;

impl InfeasibilityFile {
    /// The designs that the file's statement does not cover, where its dual multipliers are proved, by `checked`; none:
    /// no design exists. Where a bound on the multiplier is left, two solvers show how large its entries become.
    ///
    /// # Errors
    /// Dual multipliers that do not fit the model; a problem that a solver refuses.
    pub fn limits(
        &self,
        model: &Model,
        checked: &[Refutation],
    ) -> Result<Vec<Limit>, SynthesisError> {
        let sets = self.weights(model)?;
        let given = sets.first().map_or(&[][..], |set| &set.given);
        limits(model, &sets, checked, || largest_multiplier(model, given))
    }
}

/// The largest entry of Qh (SI units) that a solver returns for the smallest gain and for the smallest slack;
/// infinite where a solver returns none, or numbers that are not finite.
fn largest_multiplier(model: &Model, given: &[DMatrix<f64>]) -> Result<f64, SynthesisError> {
    let mut task = model.task();
    if !given.is_empty() {
        task.gains = GainPlan::given(given, None);
    }
    let largest = |session: &mut Session| {
        let gain = largest_entry(&task, session, Goal::SmallestGain)?;
        Ok(gain.max(largest_entry(&task, session, Goal::SmallestSlack)?))
    };
    let solvers = Solvers::both([Solver::Structured, Solver::Clarabel]);
    let mut session = Session::new(&solvers, None);
    let first = largest(&mut session)?;
    let largest = session.with_other(largest)?.unwrap_or(0.0).max(first);
    Ok(match largest > 0.0 {
        true => largest,
        false => f64::INFINITY,
    })
}

fn largest_entry(task: &Task, session: &mut Session, goal: Goal) -> Result<f64, SynthesisError> {
    let solved = session.solve(scaled(task, &FIRST_UNITS), goal)?;
    let units = DMatrix::from_diagonal(&solved.scaling.state);
    let multiplier = &solved.assembled.design.multiplier;
    let multiplier = &units * multiplier.value(&solved.solution.values) * &units;
    Ok(largest_magnitude(multiplier.iter()))
}
