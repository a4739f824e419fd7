//! From coordinates in (0, 1) to a changed scenario: one kind of dispersion each.

use nalgebra::{DMatrix, DVector, Vector3};
use runtime::attitude::Quaternion;
use serde_json::Value;
use synth::model::ModelError;

use crate::batch::variation::parameter::{Parameter, ParameterError};
use crate::plants::rigid_body::check::attitude as attitude_of;
use crate::plants::rigid_body::{AttitudeFile, FaultFile, RigidBodyFile};
use crate::plants::takagi_sugeno::TakagiSugenoFile;
use crate::plants::SystemFile;
use crate::scenario::distribution::{direction, direction_of_any_size, rotation, Distribution};
use crate::scenario::{ChangeFile, Dispersion, FaultDispersion, ScenarioFile};

/// What is sampled for every run, with what it needs to know of the scenario.
#[derive(Debug, Clone)]
pub(crate) struct Sampler {
    pub dispersion: Dispersion,
    pub context: Context,
}

/// What a dispersion needs to know of the scenario.
#[derive(Debug, Clone)]
pub(crate) enum Context {
    /// Nothing.
    Nothing,
    /// A number's place in the file, and its value there.
    Number(Parameter, f64),
    /// The certified set.
    Boundary(Boundary),
}

/// The set x'Ux = level.
#[derive(Debug, Clone)]
pub(crate) struct Boundary {
    /// Inverse of the transpose of the Cholesky factor of U, times the square root of the level.
    pub map: DMatrix<f64>,
    /// Desired attitude, for a spacecraft.
    pub desired: Option<Quaternion>,
}

const AXES: [&str; 6] = ["11", "22", "33", "12", "13", "23"];
const PLACES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

fn numbered(name: &str, unit: &str, count: usize) -> Vec<String> {
    let numbers = 1..=count;
    numbers
        .map(|number| format!("{name}_{number}{unit}"))
        .collect()
}

fn attitude_columns() -> Vec<String> {
    let mut names = vec!["initial_q0_scalar".to_string()];
    names.extend((1..=3).map(|number| format!("initial_q{number}")));
    names
}

impl Sampler {
    /// Coordinates that it uses.
    pub fn numbers(&self) -> usize {
        match &self.dispersion {
            Dispersion::Number { .. } | Dispersion::Factor(_) => 1,
            Dispersion::AnyAttitude | Dispersion::Turn(_) | Dispersion::Rate(_) => 3,
            Dispersion::State(_, count) | Dispersion::Phase(_, count) => *count,
            Dispersion::Boundary { .. } => match &self.context {
                Context::Boundary(boundary) => boundary.map.nrows(),
                _ => 0,
            },
            Dispersion::Inertia(parts) => 3 * parts.iter().flatten().count(),
            Dispersion::Fault(_) => 5,
        }
    }

    /// Names of the columns of what is drawn, with units.
    pub fn columns(&self) -> Vec<String> {
        match (&self.dispersion, &self.context) {
            (Dispersion::Number { .. }, Context::Number(parameter, _)) => {
                vec![parameter.name.clone()]
            }
            (Dispersion::AnyAttitude | Dispersion::Turn(_), _) => attitude_columns(),
            (Dispersion::Rate(_), _) => numbered("initial_rate", "_rad_s", 3),
            (Dispersion::State(_, count), _) => numbered("initial_state", "", *count),
            (Dispersion::Boundary { .. }, Context::Boundary(boundary)) => match boundary.desired {
                None => numbered("initial_state", "", boundary.map.nrows()),
                Some(_) => [attitude_columns(), numbered("initial_rate", "_rad_s", 3)].concat(),
            },
            (Dispersion::Inertia(parts), _) => {
                let (moments, products) = AXES.split_at(3);
                let names = [moments, products].into_iter().zip(parts);
                let names = names.filter(|(_, part)| part.is_some());
                let names = names.flat_map(|(names, _)| names);
                names.map(|name| format!("inertia_{name}_kg_m2")).collect()
            }
            (Dispersion::Factor(_), _) => vec!["disturbance_factor".to_string()],
            (Dispersion::Phase(_, count), _) => numbered("disturbance_phase", "_deg", *count),
            (Dispersion::Fault(fault), _) => ["axis", "from_s", "until_s", "effectiveness"]
                .map(|name| format!("fault_{}_{name}", fault.number))
                .into(),
            (Dispersion::Number { .. } | Dispersion::Boundary { .. }, _) => Vec::new(),
        }
    }

    /// Sets a number of the file; the other kinds do not apply to it.
    pub fn set(
        &self,
        at: &[f64],
        file: &mut Value,
        drawn: &mut Vec<Option<f64>>,
    ) -> Result<(), ParameterError> {
        let (
            Dispersion::Number {
                distribution,
                change,
                ..
            },
            Context::Number(parameter, base),
        ) = (&self.dispersion, &self.context)
        else {
            return Ok(());
        };
        let value = distribution.value(at[0]);
        let value = match change {
            ChangeFile::Replace => value,
            ChangeFile::Add => base + value,
            ChangeFile::Multiply => base * value,
        };
        drawn.push(Some(value));
        parameter.set(file, value)
    }

    /// Changes the scenario.
    pub fn apply(
        &self,
        at: &[f64],
        file: &mut ScenarioFile,
        drawn: &mut Vec<Option<f64>>,
    ) -> Result<(), ModelError> {
        let duration_s = file.duration_s;
        match (&mut file.system, &self.context) {
            (_, Context::Number(..)) => {}
            (SystemFile::RigidBody(body), Context::Boundary(boundary)) => {
                boundary.start(at, body, drawn)?;
            }
            (SystemFile::TakagiSugeno(model), Context::Boundary(boundary)) => {
                let state = boundary.state(at);
                model.initial_state = state.iter().copied().collect();
                drawn.extend(state.iter().copied().map(Some));
            }
            (SystemFile::RigidBody(body), Context::Nothing) => {
                change_body(&self.dispersion, at, body, duration_s, drawn)?;
            }
            (SystemFile::TakagiSugeno(model), Context::Nothing) => {
                change_model(&self.dispersion, at, model, drawn);
            }
        }
        Ok(())
    }
}

fn change_model(
    dispersion: &Dispersion,
    at: &[f64],
    model: &mut TakagiSugenoFile,
    drawn: &mut Vec<Option<f64>>,
) {
    match dispersion {
        Dispersion::State(distribution, _) => {
            for (value, &u) in model.initial_state.iter_mut().zip(at) {
                *value += distribution.value(u);
                drawn.push(Some(*value));
            }
        }
        Dispersion::Factor(distribution) => {
            let factor = distribution.value(at[0]);
            scale_signal(model, factor);
            drawn.push(Some(factor));
        }
        Dispersion::Phase(distribution, _) => {
            for (sine, &u) in model.disturbance.sines.iter_mut().zip(at) {
                let phase_deg = distribution.value(u);
                let size = sine.sine.len().max(sine.cosine.len());
                sine.sine.resize(size, 0.0);
                sine.cosine.resize(size, 0.0);
                shift(phase_deg, &mut sine.sine, &mut sine.cosine);
                drawn.push(Some(phase_deg));
            }
        }
        // The rest is refused for this kind of plant.
        _ => {}
    }
}

fn change_body(
    dispersion: &Dispersion,
    at: &[f64],
    body: &mut RigidBodyFile,
    duration_s: f64,
    drawn: &mut Vec<Option<f64>>,
) -> Result<(), ModelError> {
    match dispersion {
        Dispersion::AnyAttitude => {
            let attitude = rotation([at[0], at[1], at[2]]);
            body.initial_attitude = AttitudeFile::QuaternionScalarFirst(attitude);
            drawn.extend(attitude.map(Some));
        }
        Dispersion::Turn(distribution) => {
            let from = attitude_of("initial_attitude", &body.initial_attitude)?;
            let half = 0.5 * distribution.value(at[0]).to_radians();
            let (sine, cosine) = libm::sincos(half);
            let turn = Quaternion::new(cosine, direction([at[1], at[2]]) * sine);
            let attitude = (from * turn).to_scalar_first();
            body.initial_attitude = AttitudeFile::QuaternionScalarFirst(attitude);
            drawn.extend(attitude.map(Some));
        }
        Dispersion::Rate(distribution) => {
            for (rate, &u) in body.initial_rate_rad_s.iter_mut().zip(at) {
                *rate += distribution.value(u);
                drawn.push(Some(*rate));
            }
        }
        Dispersion::Inertia(parts) => change_inertia(parts, at, body, drawn),
        Dispersion::Factor(distribution) => {
            let factor = distribution.value(at[0]);
            scale_torque(body, factor);
            drawn.push(Some(factor));
        }
        Dispersion::Phase(distribution, _) => {
            for (sine, &u) in body.disturbance.sines.iter_mut().zip(at) {
                let phase_deg = distribution.value(u);
                shift(phase_deg, &mut sine.sine_nm, &mut sine.cosine_nm);
                drawn.push(Some(phase_deg));
            }
        }
        Dispersion::Fault(dispersion) => {
            let fault = fault_of(dispersion, at, duration_s);
            let numbers = fault.as_ref().map(|fault| {
                let axis = f64::from(fault.axis);
                [axis, fault.from_s, fault.until_s, fault.effectiveness]
            });
            drawn.extend(numbers.map_or([None; 4], |numbers| numbers.map(Some)));
            body.faults.extend(fault);
        }
        // These have a context of their own, or are refused for a spacecraft.
        Dispersion::Number { .. } | Dispersion::Boundary { .. } | Dispersion::State(..) => {}
    }
    Ok(())
}

impl Boundary {
    fn state(&self, at: &[f64]) -> DVector<f64> {
        &self.map * DVector::from_vec(direction_of_any_size(at))
    }

    /// The attitude and rate whose errors are the state.
    fn start(
        &self,
        at: &[f64],
        body: &mut RigidBodyFile,
        drawn: &mut Vec<Option<f64>>,
    ) -> Result<(), ModelError> {
        let state = self.state(at);
        let part = |first: usize| {
            Vector3::from_fn(|row, _| state.get(first + row).copied().unwrap_or(0.0))
        };
        let (rate, vector) = (part(0), part(3));
        let length = vector.norm();
        if length > 1.0 {
            return Err(ModelError::OutOfRange {
                field: "dispersions.certified_boundary.level".to_string(),
                value: length,
                allowed:
                    "so small that every start has an attitude error of at most 180 deg; this is \
                          the length of the error quaternion's vector part, which is at most 1"
                        .to_string(),
            });
        }
        let error = Quaternion::new(libm::sqrt((1.0 - length) * (1.0 + length)), vector);
        let desired = self.desired.unwrap_or_else(Quaternion::identity);
        let attitude = (desired * error).to_scalar_first();
        body.initial_attitude = AttitudeFile::QuaternionScalarFirst(attitude);
        body.initial_rate_rad_s = rate.into();
        drawn.extend(attitude.map(Some));
        drawn.extend(body.initial_rate_rad_s.map(Some));
        Ok(())
    }
}

/// The fault, if it happens.
fn fault_of(dispersion: &FaultDispersion, at: &[f64], duration_s: f64) -> Option<FaultFile> {
    if at[0] > dispersion.probability {
        return None;
    }
    let from_s = dispersion.from_s.value(at[2]);
    let until_s = match &dispersion.duration_s {
        Some(distribution) => from_s + distribution.value(at[3]),
        // A fault after the end of the run must be a valid one too.
        None => duration_s.max(from_s + 1.0),
    };
    Some(FaultFile {
        axis: dispersion.axis.unwrap_or(1 + ((3.0 * at[1]) as u32).min(2)),
        from_s,
        until_s,
        effectiveness: dispersion.effectiveness.value(at[4]),
        additive_nm: 0.0,
        additive_wave: None,
    })
}

fn change_inertia(
    parts: &[Option<Distribution>; 2],
    at: &[f64],
    body: &mut RigidBodyFile,
    drawn: &mut Vec<Option<f64>>,
) {
    let (moments, products) = PLACES.split_at(3);
    let mut at = at.iter();
    for (part, places) in parts.iter().zip([moments, products]) {
        let Some(distribution) = part else { continue };
        for (&(row, column), &u) in places.iter().zip(at.by_ref().take(places.len())) {
            let value = body.inertia_kg_m2[row][column] * (1.0 + 0.01 * distribution.value(u));
            body.inertia_kg_m2[row][column] = value;
            body.inertia_kg_m2[column][row] = value;
            drawn.push(Some(value));
        }
    }
}

fn scale_torque(body: &mut RigidBodyFile, factor: f64) {
    let disturbance = &mut body.disturbance;
    let sines = disturbance.sines.iter_mut();
    let sines = sines.flat_map(|sine| [&mut sine.sine_nm, &mut sine.cosine_nm]);
    let rows = disturbance.table.iter_mut().map(|row| &mut row.torque_nm);
    let all = sines.chain(rows).chain([&mut disturbance.bias_nm]);
    all.flatten().for_each(|value| *value *= factor);
}

fn scale_signal(model: &mut TakagiSugenoFile, factor: f64) {
    let disturbance = &mut model.disturbance;
    let sines = disturbance.sines.iter_mut();
    let sines = sines.flat_map(|sine| [&mut sine.sine, &mut sine.cosine]);
    let all = sines.chain([&mut disturbance.bias]);
    all.flatten().for_each(|value| *value *= factor);
}

/// a sin(wt + p) + b cos(wt + p) = (a cos p - b sin p) sin(wt) + (a sin p + b cos p) cos(wt).
fn shift(phase_deg: f64, sine: &mut [f64], cosine: &mut [f64]) {
    let (sin, cos) = libm::sincos(phase_deg.to_radians());
    for (a, b) in sine.iter_mut().zip(cosine) {
        (*a, *b) = (*a * cos - *b * sin, *a * sin + *b * cos);
    }
}
