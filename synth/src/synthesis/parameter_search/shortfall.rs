//! Why a search did not reach what was asked for, and what holds it back.

use super::inner::{Aim, Inner, SearchPoint, Turn};
use super::parameters::Parameter;
use crate::model::{ModelFile, PlantFile};
use crate::programs::{Sensitivity, SynthesisError};

/// Effects below this are left out.
const SMALLEST: f64 = 0.01;

/// What a number of the model does to the value.
struct Knob {
    what: String,
    value: f64,
    turn: Box<Turn>,
}

fn knobs(file: &ModelFile, fixed: &[Parameter]) -> Vec<Knob> {
    let mut out = Vec::new();
    let mut push = |what: &str, value: f64, turn: Box<Turn>| {
        if value > 0.0 {
            let what = what.to_string();
            out.push(Knob { what, value, turn });
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
        let turn = move |file: &mut ModelFile, factor: f64| {
            if let Some(value) = parameter.of(file) {
                parameter.set(file, value * factor);
            }
        };
        push(&what, value, Box::new(turn));
    }
    out
}

/// What holds a point back: the numbers that the search could not change (further), by their effect.
pub fn sensitivities(
    inner: &Inner<'_>,
    point: &SearchPoint,
) -> Result<Vec<Sensitivity>, SynthesisError> {
    let file = inner.space.at(&point.coordinates);
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
        let ranges = inner.space.ranges.iter().zip(&point.coordinates);
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
    let knobs = knobs(&file, &fixed);
    let turns: Vec<&Turn> = knobs.iter().map(|knob| &*knob.turn).collect();
    let slopes = inner.slopes_along(point, &turns)?;
    let mut out: Vec<Sensitivity> = knobs
        .iter()
        .zip(slopes)
        .map(|(knob, per_cent)| Sensitivity {
            what: knob.what.clone(),
            value: knob.value,
            per_cent,
        })
        .collect();
    if let Aim::Reach {
        gamma_max: Some(gamma),
        ..
    } = inner.aim
    {
        if let Some(per_cent) = inner.slope_along_gamma(point)? {
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
