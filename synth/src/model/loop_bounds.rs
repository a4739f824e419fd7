//! The imperfections of a model: their checks, and the bounds as the conditions see them.

use nalgebra::DVector;

use super::file::{GainForm, ModelFile, PlantFile, RulesSystem};
use super::imperfections::{
    is_none, Effectiveness, Imperfections, MeasurementBounds, TriggerFloor,
};
use super::ranges::{check_count, require, MAX_COLUMNS};
use super::{ModelError, Plant};
use crate::conditions::{FloorSupply, GainErrorSet, LoopImperfections, MeasurementError};
use crate::fuzzy::TakagiSugeno;

/// The most consecutive transmissions that a model may let be lost.
const MOST_LOST: u32 = 100;

fn refuse(key: &str, reason: &str) -> Result<(), ModelError> {
    Err(ModelError::choice(
        format!("imperfections.{key}"),
        reason.to_string(),
    ))
}

/// Checks what the ranges of single numbers leave open.
pub(super) fn check_imperfections(file: &ModelFile, plant: &Plant) -> Result<(), ModelError> {
    let imperfections = &file.imperfections;
    check_forms(file, plant)?;
    if let Some(measurement) = &imperfections.measurement {
        check_measurement(measurement, file, plant)?;
    }
    let lost = imperfections.lost_in_a_row;
    let allowed = "in 0 to 100";
    let field = "imperfections.lost_in_a_row";
    require(lost <= MOST_LOST, field, f64::from(lost), allowed)?;
    let oldest = imperfections.oldest_sample_s(file.specs.hbar_s);
    let ok = file.specs.phi_per_s * oldest <= 100.0;
    let allowed = "such that (lost_in_a_row + 1) hbar_s + delay_s is at most 100 / phi_per_s";
    require(ok, "imperfections.delay_s", imperfections.delay_s, allowed)?;
    let inputs = plant.sizes().1;
    check_effectiveness(imperfections, inputs)?;
    check_floor(file)
}

/// What only some plants and gains have.
fn check_forms(file: &ModelFile, plant: &Plant) -> Result<(), ModelError> {
    let imperfections = &file.imperfections;
    let exact = matches!(plant, Plant::Spacecraft(_));
    if imperfections.wheel_momentum_nms.is_some() && !exact {
        return refuse("wheel_momentum_nms", "needs an 'exact' plant");
    }
    if imperfections.reference.is_some() && !exact {
        return refuse("reference", "needs an 'exact' plant");
    }
    if imperfections.torque_quantum_nm > 0.0 && !exact {
        return refuse("torque_quantum_nm", "needs an 'exact' plant");
    }
    let constant = file.gains == GainForm::Constant;
    match constant || is_none(imperfections) {
        true => Ok(()),
        false => Err(ModelError::choice(
            "imperfections",
            "are proved for constant gains only; leave them out, or use \"constant\"",
        )),
    }
}

fn check_measurement(
    bounds: &MeasurementBounds,
    file: &ModelFile,
    plant: &Plant,
) -> Result<(), ModelError> {
    let spacecraft = match &file.plant {
        PlantFile::Exact(_) => true,
        PlantFile::Rules(rules) => matches!(rules.system, RulesSystem::Spacecraft(_)),
        PlantFile::Vertices(_) => false,
    };
    match (spacecraft, &bounds.state) {
        (true, Some(_)) => {
            return refuse(
                "measurement.state",
                "a spacecraft has rate_rad_s and attitude_deg in its place",
            );
        }
        (false, None) => {
            return refuse(
                "measurement.state",
                "is missing: it bounds the error of each state",
            );
        }
        _ => {}
    }
    if let Some(state) = &bounds.state {
        if bounds.rate_rad_s.is_some() || bounds.attitude_deg.is_some() {
            return refuse(
                "measurement",
                "rate_rad_s and attitude_deg are for spacecraft only",
            );
        }
        let (found, expected) = (state.len(), plant.sizes().0);
        if found != expected {
            let [found, expected] = [found, expected].map(|count| format!("{count} entries"));
            let field = "imperfections.measurement.state";
            return Err(ModelError::shape(field, found, expected));
        }
    }
    let disturbed = plant.takagi_sugeno().disturbance_bound > 0.0;
    if bounds.is_some() && !disturbed {
        return refuse(
            "measurement",
            "needs a disturbance bound above 0: the error is weighed against the disturbance",
        );
    }
    check_attitude_error(bounds, file)
}

/// The sign of the measured quaternion follows from its scalar part, which must not vanish.
fn check_attitude_error(bounds: &MeasurementBounds, file: &ModelFile) -> Result<(), ModelError> {
    let PlantFile::Exact(exact) = &file.plant else {
        return Ok(());
    };
    let angle = bounds.attitude_deg.unwrap_or(0.0);
    let ok = 0.5 * angle.to_radians() < exact.q0_min;
    let allowed =
        "such that half of it (rad) stays below q0_min, so that the sign of the scalar part is known";
    require(ok, "imperfections.measurement.attitude_deg", angle, allowed)
}

fn check_effectiveness(imperfections: &Imperfections, inputs: usize) -> Result<(), ModelError> {
    let field = "imperfections.effectiveness";
    if let Some(Effectiveness::PerInput(pairs)) = &imperfections.effectiveness {
        check_count(field, "pairs", pairs.len(), MAX_COLUMNS)?;
        if pairs.len() != inputs {
            let [found, expected] = [pairs.len(), inputs].map(|count| format!("{count} pairs"));
            return Err(ModelError::shape(field, found, expected));
        }
    }
    for input in 0..inputs {
        let [lowest, highest] = imperfections.effectiveness_of(input);
        let allowed = "at most the highest effectiveness";
        require(lowest <= highest, field, lowest, allowed)?;
    }
    match imperfections.misalignment > 0.0 && inputs < 2 {
        true => refuse("misalignment", "needs two inputs or more"),
        false => Ok(()),
    }
}

/// A floor of the trigger is found from the measurement.
fn check_floor(file: &ModelFile) -> Result<(), ModelError> {
    let auto = matches!(file.specs.trigger_floor, Some(TriggerFloor::Auto(_)));
    match auto && file.imperfections.measurement_error().is_none() {
        true => Err(ModelError::choice(
            "specs.trigger_floor",
            "\"auto\" is found from imperfections.measurement, which is missing",
        )),
        false => Ok(()),
    }
}

/// The floor's part of the supply where it is found by the program, relative to the rest.
pub const FLOOR_SHARE: f64 = 0.3;

/// The part of an input's limit that is kept for measurement errors as long as the gain is not known.
const FIRST_RESERVE: f64 = 0.01;

/// The smallest error that the conditions are stated for, relative to the extent of the region along its state: they divide
/// by it.
const SMALLEST_ERROR: f64 = 1e-7;

/// The imperfections of a model as its conditions see them, for its plant in SI units.
pub(super) fn loop_imperfections(file: &ModelFile, system: &TakagiSugeno) -> LoopImperfections {
    let imperfections = &file.imperfections;
    let taubar_squared = system.disturbance_bound.powi(2);
    let floor = match file.specs.trigger_floor {
        None => FloorSupply::default(),
        Some(TriggerFloor::Auto(_)) => FloorSupply {
            share: FLOOR_SHARE,
            constant: 0.0,
        },
        Some(TriggerFloor::Given(floor)) => FloorSupply {
            share: 0.0,
            constant: floor / taubar_squared,
        },
    };
    let networked = imperfections.is_networked();
    let measurement = imperfections.measurement_error();
    LoopImperfections {
        oldest_sample: networked.then(|| imperfections.oldest_sample_s(file.specs.hbar_s)),
        gain_error: imperfections
            .changes_gain()
            .then(|| gain_error(imperfections, system.inputs())),
        measurement: measurement.map(|bounds| measurement_error(bounds, system)),
        floor,
    }
}

fn gain_error(imperfections: &Imperfections, inputs: usize) -> GainErrorSet {
    let ends = |input: usize| imperfections.effectiveness_of(input);
    let entries = imperfections.uncertain_gains(inputs).into_iter();
    GainErrorSet {
        centre: DVector::from_fn(inputs, |input, _| {
            let [lowest, highest] = ends(input);
            0.5 * (lowest + highest)
        }),
        entries: entries
            .map(|(i, j)| {
                let [lowest, highest] = ends(i);
                let width = match i == j {
                    true => 0.5 * (highest - lowest),
                    false => imperfections.misalignment,
                };
                ((i, j), width)
            })
            .collect(),
    }
}

fn measurement_error(bounds: &MeasurementBounds, system: &TakagiSugeno) -> MeasurementError {
    let states = system.states();
    let (mut sizes, mut balls) = (DVector::zeros(states), vec![0; states]);
    for (index, ball) in bounds.balls().iter().enumerate() {
        let extents = ball.states.iter().filter_map(|&state| system.extent(state));
        let extent = extents.reduce(f64::min).unwrap_or(1.0);
        let radius = ball.radius().max(SMALLEST_ERROR * extent);
        for &state in &ball.states {
            sizes[state] = radius / system.disturbance_bound;
            balls[state] = index;
        }
    }
    MeasurementError {
        sizes,
        balls,
        point: None,
        reserve: &system.input_limit * FIRST_RESERVE,
    }
}
