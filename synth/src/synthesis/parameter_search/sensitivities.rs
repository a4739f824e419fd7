//! The limiting factors of a search: the sensitivities of its objective.

use super::evaluator::{Evaluator, SearchPoint};
use crate::model::PlantFile;
use crate::programs::{Parameter, Sensitivity, SynthesisError};

/// Effects below this are left out.
const SMALLEST: f64 = 0.01;

/// The numbers whose effects are reported where a search cannot change them (further), with their units.
const REPORTED: [(Parameter, &str); 10] = [
    (
        Parameter::SamplingInterval,
        "longest sampling interval hbar_s [s]",
    ),
    (
        Parameter::InputLimits,
        "torque limits torque_limit_nm, all together [N m]",
    ),
    (
        Parameter::DisturbanceBound,
        "disturbance bound disturbance_bound_nm [N m]",
    ),
    (Parameter::DecayRate, "decay rate phi_per_s [1/s]"),
    (Parameter::Threshold, "trigger threshold nu"),
    (Parameter::DisturbanceWeight, "disturbance weight xi_max"),
    (Parameter::Rate(0), "box: rate_rad_s about axis 1 [rad/s]"),
    (Parameter::Rate(1), "box: rate_rad_s about axis 2 [rad/s]"),
    (Parameter::Rate(2), "box: rate_rad_s about axis 3 [rad/s]"),
    (Parameter::ScalarPart, "box: q0_min"),
];

/// The limiting factors at a point: the numbers that the search could not change (further), sorted by their effect.
pub fn sensitivities(
    evaluator: &Evaluator<'_>,
    point: &SearchPoint,
) -> Result<Vec<Sensitivity>, SynthesisError> {
    let file = evaluator.space.at(&point.coordinates);
    let free = |parameter: Parameter| {
        let ranges = evaluator.space.ranges.iter().zip(&point.coordinates);
        let mut ranges = ranges.filter(|(range, _)| range.parameter == parameter);
        ranges.any(|(range, &at)| {
            let [low, high] = range.coordinates();
            at > low + 1e-9 && at < high - 1e-9
        })
    };
    let value = |parameter: Parameter| match (parameter, &file.plant) {
        (Parameter::InputLimits, PlantFile::Exact(exact)) => {
            exact.torque_limit_nm.iter().copied().reduce(f64::max)
        }
        (Parameter::InputLimits, _) => None,
        _ => parameter.of(&file),
    };
    let fixed = REPORTED
        .into_iter()
        .filter(|(parameter, _)| !free(*parameter));
    let numbers: Vec<(Parameter, &str, f64)> = fixed
        .filter_map(|(parameter, what)| Some((parameter, what, value(parameter)?)))
        .filter(|(_, _, value)| *value > 0.0)
        .collect();
    let parameters: Vec<Parameter> = numbers.iter().map(|number| number.0).collect();
    let slopes = evaluator.slopes_along(point, &parameters)?;
    let effects = numbers.iter().zip(slopes);
    let mut out: Vec<Sensitivity> = effects
        .map(|(&(_, what, value), per_cent)| Sensitivity {
            what: what.to_string(),
            value,
            per_cent,
        })
        .collect();
    if let Some(gamma) = evaluator.aim.bounds().gamma {
        let slope = evaluator.slope_along_gamma(point)?;
        out.extend(slope.map(|per_cent| Sensitivity {
            what: "largest gain bound gamma_max".to_string(),
            value: gamma,
            per_cent,
        }));
    }
    out.retain(|entry| entry.per_cent.is_finite() && entry.per_cent.abs() >= SMALLEST);
    out.sort_by(|a, b| b.per_cent.abs().total_cmp(&a.per_cent.abs()));
    Ok(out)
}
