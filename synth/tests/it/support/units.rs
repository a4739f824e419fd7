//! Units for comparisons of solvers and of forms.

use synth::conditions::Task;
use synth::design::ProblemUnits;
use synth::model::Model;
use synth::synthesis::{scaled_task, FIRST_UNITS};

/// A model's task with one unit for all states, the smallest of those in which synthesis begins: what it is solved in
/// does not matter for what is compared, and solvers agree to the last digits in these units.
pub fn in_one_unit(model: &Model) -> Task {
    let (scaling, _) = scaled_task(model, &FIRST_UNITS);
    let units = ProblemUnits {
        state_units: vec![scaling.state.min(); scaling.state.len()],
        ..FIRST_UNITS
    };
    scaled_task(model, &units).1
}
