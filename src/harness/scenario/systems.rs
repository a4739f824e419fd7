//! The checked systems of a scenario.

use nalgebra::{Matrix3, SVector, Vector3};
use runtime::attitude::{Quaternion, NORM_TOLERANCE};
use synth::fuzzy::VertexSystem;
use synth::model::{
    check_positive, finite, ExactPlant, InertiaUncertaintyFile, Model, ModelError, ModelFile,
    Plant, PlantFile, Specs,
};

use super::check::{each, not_negative, require};
use super::inertia::drawn;
use super::system_file::{
    ActuatorsFile, AttitudeFile, FaultFile, MixingFile, ReferenceFile, RigidBodyFile, SensorsFile,
    SystemFile, TakagiSugenoFile, TorqueFile,
};
use crate::harness::actuator::{ActuatorData, Fault};
use crate::harness::disturbance::{Disturbance, Harmonic, Pulse, Table};
use crate::harness::padding;
use crate::harness::plant::{Mixing, RigidBody};
use crate::harness::reference::Reference;
use crate::harness::sensor::SensorErrors;

/// Largest Takagi-Sugeno plant: states (and disturbances).
pub const MAX_STATES: usize = 24;
/// Largest Takagi-Sugeno plant: inputs.
pub const MAX_INPUTS: usize = 12;

/// The plant with its initial state, disturbance, sensors and actuators.
#[derive(Debug, Clone)]
pub enum System {
    /// A rigid spacecraft.
    RigidBody(Box<RigidBodySystem>),
    /// A Takagi-Sugeno model.
    TakagiSugeno(Box<TakagiSugenoSystem>),
}

/// A rigid spacecraft and its surroundings.
#[derive(Debug, Clone)]
pub struct RigidBodySystem {
    /// The body.
    pub body: RigidBody,
    /// Whether its inertia was drawn from a set.
    pub inertia_is_drawn: bool,
    /// Attitude at the start.
    pub attitude: Quaternion,
    /// Body rate at the start, rad/s.
    pub rate_rad_s: Vector3<f64>,
    /// What the attitude should be.
    pub reference: Reference,
    /// Disturbance torque, N m.
    pub disturbance: Disturbance<3>,
    /// Sensor errors.
    pub sensors: SensorErrors,
    /// Actuators with their faults.
    pub actuators: ActuatorData<3>,
}

/// A Takagi-Sugeno model and its surroundings.
#[derive(Debug, Clone)]
pub struct TakagiSugenoSystem {
    /// The vertex systems.
    pub system: VertexSystem,
    /// Their weights in time.
    pub mixing: Mixing,
    /// State at the start.
    pub initial_state: Vec<f64>,
    /// Disturbance, padded.
    pub disturbance: Disturbance<MAX_STATES>,
    /// Standard deviation of the measurement of each state.
    pub state_noise: f64,
    /// Time from command to input, s.
    pub input_delay_s: f64,
}

/// Checks the system of a file.
pub(super) fn check_system(file: &SystemFile, seed: u64) -> Result<System, ModelError> {
    match file {
        SystemFile::RigidBody(body) => {
            let body = rigid_body(body, seed).map_err(|error| error.within("system.rigid_body"))?;
            Ok(System::RigidBody(Box::new(body)))
        }
        SystemFile::TakagiSugeno(model) => {
            let model = takagi_sugeno(model).map_err(|e| e.within("system.takagi_sugeno"))?;
            Ok(System::TakagiSugeno(Box::new(model)))
        }
    }
}

fn rigid_body(file: &RigidBodyFile, seed: u64) -> Result<RigidBodySystem, ModelError> {
    let nominal = inertia(&file.inertia_kg_m2)?;
    let inertia = match &file.inertia_drawn_within {
        None => nominal,
        Some(set) => drawn(&file.inertia_kg_m2, set, seed)?,
    };
    let body = RigidBody::new(inertia).ok_or(ModelError::NotPositiveDefinite {
        field: "inertia_kg_m2".to_string(),
        smallest: inertia.symmetric_eigenvalues().min(),
    })?;
    each("initial_rate_rad_s", &file.initial_rate_rad_s, finite)?;
    let mut actuators = actuators(&file.actuators)?;
    let mut disturbance = torque(&file.disturbance)?;
    for (index, fault) in file.faults.iter().enumerate() {
        let (fault, pulse) = check_fault(&format!("faults[{index}]"), fault)?;
        actuators.faults.push(fault);
        disturbance.pulses.extend(pulse);
    }
    Ok(RigidBodySystem {
        body,
        inertia_is_drawn: file.inertia_drawn_within.is_some(),
        attitude: attitude("initial_attitude", &file.initial_attitude)?,
        rate_rad_s: Vector3::from(file.initial_rate_rad_s),
        reference: reference(&file.reference)?,
        disturbance,
        sensors: sensors(&file.sensors)?,
        actuators,
    })
}

/// Specifications that play no part: only the plant of the model is used.
fn placeholder(plant: PlantFile) -> ModelFile {
    ModelFile {
        schema_version: synth::model::MODEL_SCHEMA_VERSION,
        name: String::new(),
        source: String::new(),
        plant,
        specs: Specs {
            phi_per_s: 1.0,
            hbar_s: 1.0,
            hmin_s: None,
            nu: 0.0,
            nu_min: None,
            threshold_update: None,
            eps: [1.0; 3],
            xi_max: 1.0,
            objective: Default::default(),
            must_contain: Vec::new(),
            outer: None,
            search: None,
            margin: 1e-6,
        },
        gains: Default::default(),
        mismatch: Default::default(),
    }
}

/// The same rules as for the inertia of a model file.
pub(super) fn inertia(rows: &[[f64; 3]; 3]) -> Result<Matrix3<f64>, ModelError> {
    spacecraft(rows, None).map_err(|error| relocated(error, "plant.exact.", ""))?;
    Ok(Matrix3::from_fn(|r, c| rows[r][c]))
}

/// A spacecraft of which only the inertia plays a part; errors are those of a model file.
pub(super) fn spacecraft(
    rows: &[[f64; 3]; 3],
    inertia_uncertainty: Option<InertiaUncertaintyFile>,
) -> Result<Plant, ModelError> {
    let model = placeholder(PlantFile::Exact(ExactPlant {
        inertia_kg_m2: *rows,
        inertia_uncertainty,
        torque_limit_nm: [1.0; 3],
        disturbance_bound_nm: 0.0,
        rate_rad_s: [1.0; 3],
        q0_min: 0.5,
    }));
    Ok(Model::new(model)?.plant)
}

/// The same error at another place.
pub(super) fn relocated(mut error: ModelError, from: &str, to: &str) -> ModelError {
    if let ModelError::OutOfRange { field, .. }
    | ModelError::WrongShape { field, .. }
    | ModelError::NotSymmetric { field, .. }
    | ModelError::NotPositiveDefinite { field, .. }
    | ModelError::Choice { field, .. } = &mut error
    {
        if let Some(rest) = field.strip_prefix(from) {
            *field = format!("{to}{rest}");
        }
    }
    error
}

/// The attitude of a field.
pub(crate) fn attitude(field: &str, file: &AttitudeFile) -> Result<Quaternion, ModelError> {
    match file {
        AttitudeFile::QuaternionScalarFirst(parts) => {
            let field = format!("{field}.quaternion_scalar_first");
            unit(&field, Quaternion::from_scalar_first(*parts), parts)
        }
        AttitudeFile::QuaternionScalarLast(parts) => {
            let field = format!("{field}.quaternion_scalar_last");
            unit(&field, Quaternion::from_scalar_last(*parts), parts)
        }
        AttitudeFile::Euler321Deg(angles) => {
            each(&format!("{field}.euler_321_deg"), angles, finite)?;
            let [yaw, pitch, roll] = angles.map(f64::to_radians);
            Ok(Quaternion::from_euler_321(yaw, pitch, roll))
        }
        AttitudeFile::AxisAngle(turn) => {
            let axis = unit_axis(&format!("{field}.axis_angle.axis"), &turn.axis)?;
            finite(&format!("{field}.axis_angle.angle_deg"), turn.angle_deg)?;
            let (sine, cosine) = libm::sincos(0.5 * turn.angle_deg.to_radians());
            Ok(Quaternion::new(cosine, axis * sine))
        }
    }
}

fn unit(field: &str, quaternion: Quaternion, parts: &[f64; 4]) -> Result<Quaternion, ModelError> {
    each(field, parts, finite)?;
    let norm = quaternion.norm();
    let ok = (norm - 1.0).abs() <= NORM_TOLERANCE;
    let allowed = format!("a quaternion of norm 1 (within {NORM_TOLERANCE}); this is its norm");
    require(ok, field, norm, &allowed)?;
    Ok(quaternion.normalised().unwrap_or(quaternion))
}

fn unit_axis(field: &str, axis: &[f64; 3]) -> Result<Vector3<f64>, ModelError> {
    each(field, axis, finite)?;
    let axis = Vector3::from(*axis);
    let length = axis.norm();
    require(
        length > 0.0,
        field,
        length,
        "an axis of length above 0; this is its length",
    )?;
    Ok(axis / length)
}

fn reference(file: &ReferenceFile) -> Result<Reference, ModelError> {
    match file {
        ReferenceFile::Constant(fixed) => {
            Ok(Reference::Fixed(attitude("reference.constant", fixed)?))
        }
        ReferenceFile::Slew(slew) => {
            let start = attitude("reference.slew.start", &slew.start)?;
            let axis = unit_axis("reference.slew.axis", &slew.axis)?;
            finite("reference.slew.rate_rad_s", slew.rate_rad_s)?;
            check_window("reference.slew", slew.from_s, slew.until_s)?;
            Ok(Reference::Slew {
                start,
                axis,
                rate_rad_s: slew.rate_rad_s,
                from_s: slew.from_s,
                until_s: slew.until_s,
            })
        }
        ReferenceFile::Sine(sine) => {
            let centre = attitude("reference.sine.centre", &sine.centre)?;
            let axis = unit_axis("reference.sine.axis", &sine.axis)?;
            finite("reference.sine.amplitude_deg", sine.amplitude_deg)?;
            check_positive("reference.sine.frequency_rad_s", sine.frequency_rad_s)?;
            Ok(Reference::Sine {
                centre,
                axis,
                amplitude_rad: sine.amplitude_deg.to_radians(),
                frequency_rad_s: sine.frequency_rad_s,
            })
        }
    }
}

fn check_window(field: &str, from: f64, until: f64) -> Result<(), ModelError> {
    not_negative(&format!("{field}.from_s"), from)?;
    require(
        until > from,
        &format!("{field}.until_s"),
        until,
        "above from_s",
    )
}

fn torque(file: &TorqueFile) -> Result<Disturbance<3>, ModelError> {
    each("disturbance.bias_nm", &file.bias_nm, finite)?;
    let mut harmonics = Vec::new();
    for (index, sine) in file.sines.iter().enumerate() {
        let field = format!("disturbance.sines[{index}]");
        check_positive(&format!("{field}.frequency_rad_s"), sine.frequency_rad_s)?;
        each(&format!("{field}.sine_nm"), &sine.sine_nm, finite)?;
        each(&format!("{field}.cosine_nm"), &sine.cosine_nm, finite)?;
        harmonics.push(Harmonic {
            frequency_rad_s: sine.frequency_rad_s,
            sine: Vector3::from(sine.sine_nm),
            cosine: Vector3::from(sine.cosine_nm),
        });
    }
    let mut table = Table::default();
    for (index, row) in file.table.iter().enumerate() {
        let field = format!("disturbance.table[{index}]");
        let later = table.times_s.last().is_none_or(|&last| row.time_s > last);
        let allowed = "later than in the row before";
        require(later, &format!("{field}.time_s"), row.time_s, allowed)?;
        each(&format!("{field}.torque_nm"), &row.torque_nm, finite)?;
        table.times_s.push(row.time_s);
        table.values.push(Vector3::from(row.torque_nm));
    }
    Ok(Disturbance {
        bias: Vector3::from(file.bias_nm),
        harmonics,
        table: (!table.times_s.is_empty()).then_some(table),
        pulses: Vec::new(),
    })
}

fn sensors(file: &SensorsFile) -> Result<SensorErrors, ModelError> {
    not_negative("sensors.attitude_noise_deg", file.attitude_noise_deg)?;
    not_negative("sensors.rate_noise_deg_s", file.rate_noise_deg_s)?;
    not_negative("sensors.attitude_quantum_deg", file.attitude_quantum_deg)?;
    not_negative("sensors.rate_quantum_deg_s", file.rate_quantum_deg_s)?;
    Ok(SensorErrors {
        attitude_noise_rad: file.attitude_noise_deg.to_radians(),
        rate_noise_rad_s: file.rate_noise_deg_s.to_radians(),
        attitude_quantum_rad: file.attitude_quantum_deg.to_radians(),
        rate_quantum_rad_s: file.rate_quantum_deg_s.to_radians(),
    })
}

fn actuators(file: &ActuatorsFile) -> Result<ActuatorData<3>, ModelError> {
    if let Some(limit) = &file.torque_limit_nm {
        each("actuators.torque_limit_nm", limit, check_positive)?;
    }
    each("actuators.dead_band_nm", &file.dead_band_nm, not_negative)?;
    not_negative("actuators.delay_s", file.delay_s)?;
    Ok(ActuatorData {
        limit: Vector3::from(file.torque_limit_nm.unwrap_or([f64::INFINITY; 3])),
        dead_band: Vector3::from(file.dead_band_nm),
        delay_s: file.delay_s,
        matrix: match &file.matrix {
            None => Matrix3::identity(),
            Some(rows) => {
                for (row, entries) in rows.iter().enumerate() {
                    each(&format!("actuators.matrix[{row}]"), entries, finite)?;
                }
                Matrix3::from_fn(|r, c| rows[r][c])
            }
        },
        faults: Vec::new(),
    })
}

/// A fault's share of the command that acts, and what acts on top.
fn check_fault(field: &str, file: &FaultFile) -> Result<(Fault, Option<Pulse<3>>), ModelError> {
    let ok = (1..=3).contains(&file.axis);
    require(
        ok,
        &format!("{field}.axis"),
        f64::from(file.axis),
        "1, 2 or 3",
    )?;
    check_window(field, file.from_s, file.until_s)?;
    let ok = (0.0..=1.0).contains(&file.effectiveness);
    require(
        ok,
        &format!("{field}.effectiveness"),
        file.effectiveness,
        "in [0, 1]",
    )?;
    finite(&format!("{field}.additive_nm"), file.additive_nm)?;
    let axis = file.axis as usize - 1;
    let fault = Fault {
        axis,
        from_s: file.from_s,
        until_s: file.until_s,
        effectiveness: file.effectiveness,
    };
    let along = |value: f64| Vector3::from_fn(|row, _| if row == axis { value } else { 0.0 });
    let constant = Pulse {
        from_s: file.from_s,
        until_s: file.until_s,
        constant: along(file.additive_nm),
        wave: Vector3::zeros(),
        frequency_rad_s: 0.0,
        phase_rad: 0.0,
        decay_per_s: 0.0,
    };
    let pulse = match &file.additive_wave {
        None => (file.additive_nm != 0.0).then_some(constant),
        Some(wave) => {
            let field = format!("{field}.additive_wave");
            finite(&format!("{field}.amplitude_nm"), wave.amplitude_nm)?;
            not_negative(&format!("{field}.frequency_rad_s"), wave.frequency_rad_s)?;
            finite(&format!("{field}.phase_deg"), wave.phase_deg)?;
            not_negative(&format!("{field}.decay_per_s"), wave.decay_per_s)?;
            Some(Pulse {
                wave: along(wave.amplitude_nm),
                frequency_rad_s: wave.frequency_rad_s,
                phase_rad: wave.phase_deg.to_radians(),
                decay_per_s: wave.decay_per_s,
                ..constant
            })
        }
    };
    Ok((fault, pulse))
}

fn takagi_sugeno(file: &TakagiSugenoFile) -> Result<TakagiSugenoSystem, ModelError> {
    let model = Model::new(placeholder(PlantFile::Vertices(file.vertices.clone())))
        .map_err(|error| relocated(error, "plant.vertices.", "vertices."))?;
    let Plant::Vertices(system) = model.plant else {
        return Err(length("vertices", 0, 1));
    };
    let (states, inputs) = system.input_matrix.shape();
    let sizes = [
        ("vertices.state_matrices", states, MAX_STATES),
        ("vertices.input_matrix", inputs, MAX_INPUTS),
        (
            "vertices.disturbance_matrix",
            system.disturbance_matrix.ncols(),
            MAX_STATES,
        ),
    ];
    for (field, size, largest) in sizes {
        let allowed = format!("at most {largest} columns; this is their number");
        require(size <= largest, field, size as f64, &allowed)?;
    }
    if file.initial_state.len() != states {
        return Err(length("initial_state", file.initial_state.len(), states));
    }
    each("initial_state", &file.initial_state, finite)?;
    not_negative("state_noise", file.state_noise)?;
    not_negative("input_delay_s", file.input_delay_s)?;
    Ok(TakagiSugenoSystem {
        mixing: mixing(&file.mixing, system.state_matrices.len())?,
        disturbance: signal(file, system.disturbance_matrix.ncols())?,
        initial_state: file.initial_state.clone(),
        state_noise: file.state_noise,
        input_delay_s: file.input_delay_s,
        system,
    })
}

fn length(field: &str, found: usize, expected: usize) -> ModelError {
    ModelError::WrongShape {
        field: field.to_string(),
        found: format!("{found} entries"),
        expected: format!("{expected} entries"),
    }
}

fn mixing(file: &MixingFile, vertices: usize) -> Result<Mixing, ModelError> {
    match file {
        MixingFile::Constant(weights) => {
            let field = "mixing.constant";
            if weights.len() != vertices {
                return Err(length(field, weights.len(), vertices));
            }
            each(field, weights, not_negative)?;
            let sum: f64 = weights.iter().sum();
            let ok = (sum - 1.0).abs() <= 1e-12;
            require(ok, field, sum, "weights with sum 1; this is their sum")?;
            Ok(Mixing::Constant(weights.clone()))
        }
        MixingFile::Model => Ok(Mixing::Model),
        MixingFile::Cycle(cycle) => {
            check_positive("mixing.cycle.dwell_s", cycle.dwell_s)?;
            Ok(Mixing::Cycle {
                dwell_s: cycle.dwell_s,
            })
        }
    }
}

fn signal(file: &TakagiSugenoFile, size: usize) -> Result<Disturbance<MAX_STATES>, ModelError> {
    let part = |field: &str, values: &[f64]| -> Result<SVector<f64, MAX_STATES>, ModelError> {
        if !values.is_empty() && values.len() != size {
            return Err(length(field, values.len(), size));
        }
        each(field, values, finite)?;
        Ok(padding::vector(values))
    };
    let mut harmonics = Vec::new();
    for (index, sine) in file.disturbance.sines.iter().enumerate() {
        let field = format!("disturbance.sines[{index}]");
        check_positive(&format!("{field}.frequency_rad_s"), sine.frequency_rad_s)?;
        harmonics.push(Harmonic {
            frequency_rad_s: sine.frequency_rad_s,
            sine: part(&format!("{field}.sine"), &sine.sine)?,
            cosine: part(&format!("{field}.cosine"), &sine.cosine)?,
        });
    }
    Ok(Disturbance {
        bias: part("disturbance.bias", &file.disturbance.bias)?,
        harmonics,
        table: None,
        pulses: Vec::new(),
    })
}
