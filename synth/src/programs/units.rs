//! Units of the scaled problems, and which are tried.

use nalgebra::DVector;

use crate::conditions::Task;
use crate::design::ProblemUnits;
use crate::model::Model;
use crate::scaling::Scaling;

/// State units tried one after the other, as fractions of the region's smallest extent, until a design is
/// proved. Where the certified set of a design that is not proved suggests another unit, that is tried next:
/// the set may be much smaller than the region.
pub(crate) const STATE_UNITS: [f64; 7] = [0.5, 1.0, 0.25, 2.0, 0.0625, 0.015625, 0.00390625];

/// Weights rho of the containment condition tried when the model has must-contain states.
pub(crate) const CONTAINMENT_WEIGHTS: [f64; 4] = [0.5, 1.0, 0.25, 2.0];

/// The units tried first.
pub const FIRST_UNITS: ProblemUnits =
    ProblemUnits::of_fraction(STATE_UNITS[0], CONTAINMENT_WEIGHTS[0]);

/// The model's task in the given units.
pub fn scaled_task(model: &Model, units: &ProblemUnits) -> (Scaling, Task) {
    scaled(&model.task(), units)
}

pub(crate) fn scaled(task: &Task, units: &ProblemUnits) -> (Scaling, Task) {
    let mut task = task.clone();
    task.specification.containment_weight = units.containment_weight;
    let scaling = match units.state_units.len() == task.system.states() {
        true => {
            let state = DVector::from_column_slice(&units.state_units);
            Scaling::with_state_units(&task.system, state)
        }
        false => Scaling::automatic(&task.system, units.state_fraction),
    };
    let scaled = scaling.apply(&task);
    (scaling, scaled)
}

/// The weights rho of the containment condition to be tried for a task.
pub(crate) fn containment_weights(task: &Task) -> &'static [f64] {
    match task.specification.must_contain.is_empty() {
        true => &CONTAINMENT_WEIGHTS[..1],
        false => &CONTAINMENT_WEIGHTS,
    }
}
