//! How large the entries of the multiplier become in the points that solvers return.

use nalgebra::DMatrix;

use crate::conditions::{GainPlan, Task};
use crate::model::Model;
use crate::solve::{Backend, Clarabel, Structured};
use crate::synthesis::{scaled, Form, Goal, Search, SynthesisError, FIRST_UNITS};

/// The largest entry of Qh (SI units) that a solver returns for the smallest gain and for the smallest slack;
/// infinite where a solver returns none, or numbers that are not finite.
pub(super) fn largest_multiplier(
    model: &Model,
    given: &[DMatrix<f64>],
) -> Result<f64, SynthesisError> {
    let mut task = model.task();
    if !given.is_empty() {
        task.gains = GainPlan {
            count: given.len(),
            mismatch: None,
            given: Some(given.to_vec()),
        };
    }
    let solvers: [(&dyn Backend, Form); 2] = [
        (&Structured::default(), Form::Slack),
        (&Clarabel::default(), Form::Reduced),
    ];
    let mut largest: f64 = 0.0;
    for (backend, form) in solvers {
        let mut search = Search::new(form, backend, None);
        for goal in [Goal::SmallestGain, Goal::SmallestSlack] {
            largest = largest.max(largest_entry(&task, &mut search, goal)?);
        }
    }
    Ok(match largest > 0.0 {
        true => largest,
        false => f64::INFINITY,
    })
}

fn largest_entry(task: &Task, search: &mut Search, goal: Goal) -> Result<f64, SynthesisError> {
    let (scaling, task) = scaled(task, FIRST_UNITS);
    let (assembled, solution) = search.solve(&task, goal)?;
    let units = DMatrix::from_diagonal(&scaling.state);
    let multiplier = &units * assembled.design.multiplier.value(&solution.values) * &units;
    let sizes = multiplier.iter().map(|entry| match entry.is_nan() {
        true => f64::INFINITY,
        false => entry.abs(),
    });
    Ok(sizes.fold(0.0, f64::max))
}
