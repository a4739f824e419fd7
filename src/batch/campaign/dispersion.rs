//! From coordinates in (0, 1) to a changed scenario: one kind of dispersion each.

use nalgebra::{DMatrix, DVector, Vector3};
use runtime::attitude::Quaternion;
use serde_json::Value;
use synth::model::ModelError;

use crate::batch::variation::parameter::{ParameterError, VariedNumber};
use crate::plants::rigid_body::check::attitude as attitude_of;
use crate::plants::rigid_body::{AttitudeFile, FaultFile, RigidBodyFile};
use crate::plants::{System, SystemFile};
use crate::run::design::Design;
use crate::scenario::distribution::{direction, direction_of_any_size, rotation, Distribution};
use crate::scenario::{ChangeFile, Dispersion, FaultDispersion, Scenario, ScenarioFile};
use crate::sim::reference::Reference;

/// What is sampled for every run.
#[derive(Debug, Clone)]
pub(crate) struct Sampler {
    draw: Draw,
    /// Coordinates that it uses.
    pub numbers: usize,
    /// Names of the columns of what is drawn, with units.
    pub columns: Vec<String>,
}

/// A dispersion with what it needs to know of the scenario.
#[derive(Debug, Clone)]
enum Draw {
    /// A number's place in the file, its value there, what is drawn and what is done with it.
    Number(VariedNumber, f64, Distribution, ChangeFile),
    /// A start on the certified set.
    Boundary(Boundary),
    /// All else, which needs nothing.
    Other(Dispersion),
}

/// The set x'Ux = level.
#[derive(Debug, Clone)]
struct Boundary {
    /// Inverse of the transpose of the Cholesky factor of U, times the square root of the level.
    map: DMatrix<f64>,
    /// Desired attitude, for a spacecraft.
    desired: Option<Quaternion>,
}

/// Names and places of the moments of inertia, then of the products.
const INERTIA: [(&str, usize, usize); 6] = [
    ("11", 0, 0),
    ("22", 1, 1),
    ("33", 2, 2),
    ("12", 0, 1),
    ("13", 0, 2),
    ("23", 1, 2),
];

/// The entries of the inertia matrix that are drawn: distribution, name, row and column.
fn inertia(parts: &[Option<Distribution>; 2]) -> Vec<(&Distribution, &'static str, usize, usize)> {
    let all = INERTIA.into_iter().enumerate();
    let drawn = all.filter_map(|(index, (name, row, column))| {
        Some((parts[index / 3].as_ref()?, name, row, column))
    });
    drawn.collect()
}

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
    /// The sampler of a dispersion, which has that place in its list, of a scenario and its `file`.
    ///
    /// # Errors
    /// A name that is no number of the file; a certified set without a design or with a moving reference.
    pub fn new(
        index: usize,
        dispersion: &Dispersion,
        file: &Value,
        nominal: &Scenario,
        design: Option<&Design>,
    ) -> Result<Self, ModelError> {
        let mut draw = Draw::Other(dispersion.clone());
        let (numbers, columns) = match dispersion {
            Dispersion::Number {
                name,
                distribution,
                change,
            } => {
                let (parameter, base) = number(index, name, *change, file)?;
                let columns = vec![parameter.name.clone()];
                draw = Draw::Number(parameter, base, distribution.clone(), *change);
                (1, columns)
            }
            Dispersion::Boundary { level } => {
                let boundary = Boundary::new(*level, nominal, design)?;
                let size = boundary.map.nrows();
                let columns = match boundary.desired {
                    None => numbered("initial_state", "", size),
                    Some(_) => [attitude_columns(), numbered("initial_rate", "_rad_s", 3)].concat(),
                };
                draw = Draw::Boundary(boundary);
                (size, columns)
            }
            Dispersion::AnyAttitude | Dispersion::Turn(_) => (3, attitude_columns()),
            Dispersion::Rate(_) => (3, numbered("initial_rate", "_rad_s", 3)),
            Dispersion::State(_, count) => (*count, numbered("initial_state", "", *count)),
            Dispersion::Phase(_, count) => (*count, numbered("disturbance_phase", "_deg", *count)),
            Dispersion::Factor(_) => (1, vec!["disturbance_factor".to_string()]),
            Dispersion::Inertia(parts) => {
                let names = inertia(parts).into_iter();
                let names = names.map(|(_, name, ..)| format!("inertia_{name}_kg_m2"));
                let names: Vec<String> = names.collect();
                (names.len(), names)
            }
            Dispersion::Fault(fault) => {
                let names = ["axis", "from_s", "until_s", "effectiveness"];
                let names = names.map(|name| format!("fault_{}_{name}", fault.number));
                (5, names.into())
            }
        };
        Ok(Sampler {
            draw,
            numbers,
            columns,
        })
    }

    /// Whether it draws a number of the file by its name.
    pub fn is_named(&self) -> bool {
        matches!(self.draw, Draw::Number(..))
    }

    /// Sets a number of the file and returns it; the other kinds do not apply to it.
    pub fn set(&self, at: &[f64], file: &mut Value) -> Result<Option<f64>, ParameterError> {
        let Draw::Number(parameter, base, distribution, change) = &self.draw else {
            return Ok(None);
        };
        let value = distribution.value(at[0]);
        let value = match change {
            ChangeFile::Replace => value,
            ChangeFile::Add => base + value,
            ChangeFile::Multiply => base * value,
        };
        parameter.set(file, value)?;
        Ok(Some(value))
    }

    /// Changes the scenario and returns what was drawn. What does not go with the plant is refused before.
    pub fn apply(
        &self,
        at: &[f64],
        file: &mut ScenarioFile,
    ) -> Result<Vec<Option<f64>>, ModelError> {
        let dispersion = match &self.draw {
            Draw::Number(..) => return Ok(Vec::new()),
            Draw::Boundary(boundary) => {
                let drawn = boundary.start(at, &mut file.system)?;
                return Ok(drawn.into_iter().map(Some).collect());
            }
            Draw::Other(dispersion) => dispersion,
        };
        let drawn = match (dispersion, &mut file.system) {
            (Dispersion::AnyAttitude, SystemFile::RigidBody(body)) => {
                start_with(rotation([at[0], at[1], at[2]]), body)
            }
            (Dispersion::Turn(distribution), SystemFile::RigidBody(body)) => {
                let from = attitude_of("initial_attitude", &body.initial_attitude)?;
                let half = 0.5 * distribution.value(at[0]).to_radians();
                let (sine, cosine) = libm::sincos(half);
                let turn = Quaternion::new(cosine, direction([at[1], at[2]]) * sine);
                start_with((from * turn).to_scalar_first(), body)
            }
            (Dispersion::Rate(distribution), SystemFile::RigidBody(body)) => {
                add_to_each(&mut body.initial_rate_rad_s, distribution, at)
            }
            (Dispersion::State(distribution, _), SystemFile::TakagiSugeno(model)) => {
                add_to_each(&mut model.initial_state, distribution, at)
            }
            (Dispersion::Inertia(parts), SystemFile::RigidBody(body)) => {
                let matrix = &mut body.inertia_kg_m2;
                let entries = inertia(parts).into_iter().zip(at);
                let entries = entries.map(|((distribution, _, row, column), &u)| {
                    let value = matrix[row][column] * (1.0 + 0.01 * distribution.value(u));
                    matrix[row][column] = value;
                    matrix[column][row] = value;
                    value
                });
                entries.collect()
            }
            (Dispersion::Factor(distribution), system) => {
                let factor = distribution.value(at[0]);
                scale_disturbance(system, factor);
                vec![factor]
            }
            (Dispersion::Phase(distribution, _), system) => {
                let phases_deg: Vec<f64> = at.iter().map(|&u| distribution.value(u)).collect();
                shift(system, &phases_deg);
                phases_deg
            }
            (Dispersion::Fault(dispersion), SystemFile::RigidBody(body)) => {
                let Some(fault) = fault_of(dispersion, at, file.duration_s) else {
                    return Ok(vec![None; 4]);
                };
                let axis = f64::from(fault.axis);
                let drawn = vec![axis, fault.from_s, fault.until_s, fault.effectiveness];
                body.faults.push(fault);
                drawn
            }
            _ => Vec::new(),
        };
        Ok(drawn.into_iter().map(Some).collect())
    }
}

/// A number that is drawn by name, and its value in the file.
fn number(
    index: usize,
    name: &str,
    change: ChangeFile,
    file: &Value,
) -> Result<(VariedNumber, f64), ModelError> {
    let wrong = |reason: String| ModelError::Choice {
        field: format!("dispersions.values[{index}].name"),
        reason,
    };
    let parameter = VariedNumber::find(file, name).map_err(|error| wrong(error.to_string()))?;
    match (parameter.value(file), change) {
        (Some(base), _) => Ok((parameter, base)),
        (None, ChangeFile::Replace) => Ok((parameter, 0.0)),
        (None, ChangeFile::Add | ChangeFile::Multiply) => {
            let reason = format!("'{name}' stands for several different numbers");
            Err(wrong(reason))
        }
    }
}

impl Boundary {
    fn new(level: f64, nominal: &Scenario, design: Option<&Design>) -> Result<Self, ModelError> {
        let wrong = |reason: &str| ModelError::Choice {
            field: "dispersions.certified_boundary".to_string(),
            reason: reason.to_string(),
        };
        let none = "the set is that of a design, and the controller has none";
        let design = design.ok_or_else(|| wrong(none))?;
        let desired = match &nominal.system {
            System::TakagiSugeno(_) => None,
            System::RigidBody(body) => match body.reference {
                Reference::Fixed(desired) => Some(desired),
                _ => return Err(wrong("the reference must be constant; it moves")),
            },
        };
        let lower = design.certificate.lyapunov.clone().cholesky();
        let map = lower.and_then(|factor| factor.l().transpose().try_inverse());
        let map = map.ok_or_else(|| wrong("the design's matrix U is not positive definite"))?;
        Ok(Boundary {
            map: map * level.sqrt(),
            desired,
        })
    }

    /// Starts in a state of the set; of a spacecraft, in the attitude and rate whose errors are the state.
    fn start(&self, at: &[f64], system: &mut SystemFile) -> Result<Vec<f64>, ModelError> {
        let state = &self.map * DVector::from_vec(direction_of_any_size(at));
        let body = match system {
            SystemFile::RigidBody(body) => body,
            SystemFile::TakagiSugeno(model) => {
                model.initial_state = state.iter().copied().collect();
                return Ok(model.initial_state.clone());
            }
        };
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
        body.initial_rate_rad_s = rate.into();
        let mut drawn = start_with((desired * error).to_scalar_first(), body);
        drawn.extend(body.initial_rate_rad_s);
        Ok(drawn)
    }
}

/// Starts with an attitude, the scalar part first.
fn start_with(attitude: [f64; 4], body: &mut RigidBodyFile) -> Vec<f64> {
    body.initial_attitude = AttitudeFile::QuaternionScalarFirst(attitude);
    attitude.into()
}

/// Adds a number of its own to each value.
fn add_to_each(values: &mut [f64], distribution: &Distribution, at: &[f64]) -> Vec<f64> {
    let pairs = values.iter_mut().zip(at);
    pairs.for_each(|(value, &u)| *value += distribution.value(u));
    values.to_vec()
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

/// The amplitudes of the sines and cosines of a disturbance.
fn waves(system: &mut SystemFile) -> Vec<[&mut [f64]; 2]> {
    match system {
        SystemFile::RigidBody(body) => {
            let sines = body.disturbance.sines.iter_mut();
            sines
                .map(|sine| [&mut sine.sine_nm[..], &mut sine.cosine_nm[..]])
                .collect()
        }
        SystemFile::TakagiSugeno(model) => {
            let sines = model.disturbance.sines.iter_mut();
            sines
                .map(|sine| [&mut sine.sine[..], &mut sine.cosine[..]])
                .collect()
        }
    }
}

fn scale_disturbance(system: &mut SystemFile, factor: f64) {
    let scale = |values: &mut [f64]| values.iter_mut().for_each(|value| *value *= factor);
    waves(system).into_iter().flatten().for_each(scale);
    match system {
        SystemFile::RigidBody(body) => {
            scale(&mut body.disturbance.bias_nm);
            let table = body.disturbance.table.iter_mut();
            table.for_each(|row| scale(&mut row.torque_nm));
        }
        SystemFile::TakagiSugeno(model) => scale(&mut model.disturbance.bias),
    }
}

/// a sin(wt + p) + b cos(wt + p) = (a cos p - b sin p) sin(wt) + (a sin p + b cos p) cos(wt).
fn shift(system: &mut SystemFile, phases_deg: &[f64]) {
    if let SystemFile::TakagiSugeno(model) = system {
        for sine in &mut model.disturbance.sines {
            let size = sine.sine.len().max(sine.cosine.len());
            sine.sine.resize(size, 0.0);
            sine.cosine.resize(size, 0.0);
        }
    }
    for ([sine, cosine], phase_deg) in waves(system).into_iter().zip(phases_deg) {
        let (sin, cos) = libm::sincos(phase_deg.to_radians());
        for (a, b) in sine.iter_mut().zip(cosine) {
            (*a, *b) = (*a * cos - *b * sin, *a * sin + *b * cos);
        }
    }
}
