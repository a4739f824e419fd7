//! The limiting factors of a search: the sensitivities of its objective.

use super::evaluator::{Aim, Evaluator, Perturbation, SearchPoint};
use super::parameters::Parameter;
use crate::model::{ModelFile, PlantFile};
use crate::programs::{Sensitivity, SynthesisError};

/// Effects below this are left out.
const SMALLEST: f64 = 0.01;

/// A number of the model, and its perturbation.
struct ModelNumber {
    what: String,
    value: f64,
    perturb: Box<Perturbation>,
}

fn numbers(file: &ModelFile, fixed: &[Parameter]) -> Vec<ModelNumber> {
    let mut out = Vec::new();
    let mut push = |what: &str, value: f64, perturb: Box<Perturbation>| {
        if value > 0.0 {
            let what = what.to_string();
            out.push(ModelNumber {
                what,
                value,
                perturb,
            });
        }
    };
    push(
        "longest sampling interval hbar_s [s]",
        file.specs.hbar_s,
        Box::new(|file, factor| file.specs.hbar_s *= factor),
    );
    if let PlantFile::Exact(exact) = &file.plant {
        let largest = exact
            .torque_limit_nm
            .iter()
            .fold(0.0, |a: f64, b| a.max(*b));
        push(
            "torque limits torque_limit_nm, all together [N m]",
            largest,
            Box::new(|file, factor| {
                if let PlantFile::Exact(exact) = &mut file.plant {
                    exact
                        .torque_limit_nm
                        .iter_mut()
                        .for_each(|limit| *limit *= factor);
                }
            }),
        );
        push(
            "disturbance bound disturbance_bound_nm [N m]",
            exact.disturbance_bound_nm,
            Box::new(|file, factor| {
                if let PlantFile::Exact(exact) = &mut file.plant {
                    exact.disturbance_bound_nm *= factor;
                }
            }),
        );
    }
    for &parameter in fixed {
        let Some(value) = parameter.of(file) else {
            continue;
        };
        let what = match parameter {
            Parameter::DecayRate => "decay rate phi_per_s [1/s]".to_string(),
            Parameter::Threshold => "trigger threshold nu".to_string(),
            Parameter::DisturbanceWeight => "disturbance weight xi_max".to_string(),
            Parameter::Rate(axis) => format!("box: rate_rad_s about axis {} [rad/s]", axis + 1),
            Parameter::ScalarPart => "box: q0_min".to_string(),
            Parameter::FirstWeight => "eps_1".to_string(),
            Parameter::ThirdWeight => "eps_3".to_string(),
        };
        let perturb = move |file: &mut ModelFile, factor: f64| {
            if let Some(value) = parameter.of(file) {
                parameter.set(file, value * factor);
            }
        };
        push(&what, value, Box::new(perturb));
    }
    out
}

/// The limiting factors at a point: the numbers that the search could not change (further), sorted by their effect.
pub fn sensitivities(
    evaluator: &Evaluator<'_>,
    point: &SearchPoint,
) -> Result<Vec<Sensitivity>, SynthesisError> {
    let file = evaluator.space.at(&point.coordinates);
    let all = [
        Parameter::DecayRate,
        Parameter::Threshold,
        Parameter::DisturbanceWeight,
        Parameter::Rate(0),
        Parameter::Rate(1),
        Parameter::Rate(2),
        Parameter::ScalarPart,
    ];
    let free = |parameter: &Parameter| {
        let ranges = evaluator.space.ranges.iter().zip(&point.coordinates);
        let mut ranges = ranges.filter(|(range, _)| range.parameter == *parameter);
        ranges.any(|(range, &at)| {
            let [low, high] = range.coordinates();
            at > low + 1e-9 && at < high - 1e-9
        })
    };
    let fixed: Vec<Parameter> = all
        .into_iter()
        .filter(|parameter| !free(parameter))
        .collect();
    let numbers = numbers(&file, &fixed);
    let perturbations: Vec<&Perturbation> = numbers.iter().map(|number| &*number.perturb).collect();
    let slopes = evaluator.slopes_along(point, &perturbations)?;
    let mut out: Vec<Sensitivity> = numbers
        .iter()
        .zip(slopes)
        .map(|(number, per_cent)| Sensitivity {
            what: number.what.clone(),
            value: number.value,
            per_cent,
        })
        .collect();
    if let Aim::Reach {
        gamma_max: Some(gamma),
        ..
    } = evaluator.aim
    {
        if let Some(per_cent) = evaluator.slope_along_gamma(point)? {
            let what = "largest gain bound gamma_max".to_string();
            let value = *gamma;
            out.push(Sensitivity {
                what,
                value,
                per_cent,
            });
        }
    }
    out.retain(|entry| entry.per_cent.is_finite() && entry.per_cent.abs() >= SMALLEST);
    out.sort_by(|a, b| b.per_cent.abs().total_cmp(&a.per_cent.abs()));
    Ok(out)
}
