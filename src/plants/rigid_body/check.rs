//! The rigid spacecraft and its surroundings, checked.

use nalgebra::{Matrix3, Vector3};
use runtime::attitude::{Quaternion, NORM_TOLERANCE};
use synth::model::{check_positive, finite, ModelError};

use super::file::{
    ActuatorsFile, AttitudeFile, FaultFile, ReferenceFile, RigidBodyFile, SensorsFile, TorqueFile,
};
use super::inertia::{drawn, inertia};
use super::RigidBody;
use crate::base::ranges::{each, not_negative, require};
use crate::sim::actuator::{ActuatorData, Fault};
use crate::sim::disturbance::{Disturbance, DisturbanceTable, Harmonic, Pulse};
use crate::sim::reference::Reference;
use crate::sim::sensor::SensorErrors;

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

pub(crate) fn rigid_body(file: &RigidBodyFile, seed: u64) -> Result<RigidBodySystem, ModelError> {
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
    let mut table = DisturbanceTable::default();
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

/// A fault's fraction of the command that acts, and what acts on top.
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
