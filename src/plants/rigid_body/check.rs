//! The rigid spacecraft and its surroundings, checked: what relates several numbers of the file.

use nalgebra::{Matrix3, Vector3};
use runtime::attitude::{Quaternion, NORM_TOLERANCE};
use synth::model::{
    check_inertia, check_not_negative, finite, readable, spacecraft, ExactPlant,
    InertiaUncertaintyFile, ModelError,
};

use super::file::{
    AttitudeFile, BoundedErrorFile, FaultFile, ReferenceFile, RigidBodyFile, SensorsFile,
    TorqueFile,
};
use super::wheels::Wheels;
use super::RigidBody;
use crate::base::bounded::plain;
use crate::base::plant_model::relocated;
use crate::base::ranges::{each, require};
use crate::sim::actuator::{ActuatorData, AnyEffect};
use crate::sim::disturbance::{Disturbance, DisturbanceTable, Harmonic, Pulse};
use crate::sim::effect::Fault;
use crate::sim::measurement_error::{check_direction, ErrorBounds, ErrorGroup};
use crate::sim::plant::PlantFile;
use crate::sim::random::{Purpose, Random};
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
    /// Reaction wheels that give the torque.
    pub wheels: Option<Wheels>,
}

impl PlantFile for RigidBodyFile {
    type System = RigidBodySystem;

    /// The rate is the body's where the reference rests.
    const QUANTITIES: &'static [&'static str] = &["error_deg", "rate_rad_s"];

    fn check(&self, seed: u64) -> Result<RigidBodySystem, ModelError> {
        let nominal = check_inertia("inertia_kg_m2", &self.inertia_kg_m2)?;
        let inertia = match &self.inertia_drawn_within {
            None => nominal,
            Some(set) => drawn(&self.inertia_kg_m2, set, seed)?,
        };
        let body = RigidBody::new(inertia).ok_or(ModelError::NotPositiveDefinite {
            field: "inertia_kg_m2".to_string(),
            smallest: inertia.symmetric_eigenvalues().min(),
        })?;
        each("initial_rate_rad_s", &self.initial_rate_rad_s, finite)?;
        let mut actuators = self.actuators.data()?;
        let mut disturbance = torque(&self.disturbance)?;
        for (index, fault) in self.faults.iter().enumerate() {
            let (fault, pulse) = check_fault(&format!("faults[{index}]"), fault)?;
            actuators.effects.push(AnyEffect::Fault(fault));
            disturbance.pulses.extend(pulse);
        }
        Ok(RigidBodySystem {
            body,
            inertia_is_drawn: self.inertia_drawn_within.is_some(),
            attitude: attitude("initial_attitude", &self.initial_attitude)?,
            rate_rad_s: Vector3::from(self.initial_rate_rad_s),
            reference: reference(&self.reference)?,
            disturbance,
            sensors: self.sensors.errors()?,
            actuators,
            wheels: self
                .wheels
                .as_ref()
                .map(|wheels| wheels.check())
                .transpose()?,
        })
    }
}

/// An inertia drawn from the set about `rows`, every entry uniform and independent of the others.
fn drawn(
    rows: &[[f64; 3]; 3],
    set: &InertiaUncertaintyFile,
    seed: u64,
) -> Result<Matrix3<f64>, ModelError> {
    // Only the inertia and its set play a part.
    let craft = spacecraft(&ExactPlant {
        inertia_kg_m2: *rows,
        inertia_uncertainty: Some(*set),
        torque_limit_nm: [1.0; 3],
        disturbance_bound_nm: 0.0,
        rate_rad_s: [1.0; 3],
        q0_min: 0.5,
        gyroscopic_form_kg_m2: None,
        output_weights: None,
    });
    let craft = craft.map_err(|error| {
        let from = "plant.exact.inertia_uncertainty";
        relocated(error, from, "inertia_drawn_within")
    })?;
    let mut random = Random::new(seed, Purpose::Inertia);
    let places = std::array::from_fn(|_| random.uniform());
    Ok(craft.inertia_uncertainty.member(&craft.inertia, &places))
}

/// The attitude of a field.
pub(crate) fn attitude(field: &str, file: &AttitudeFile) -> Result<Quaternion, ModelError> {
    match file {
        AttitudeFile::QuaternionScalarFirst(parts) => {
            let field = format!("{field}.quaternion_scalar_first");
            unit(&field, Quaternion::from_scalar_first(*parts))
        }
        AttitudeFile::QuaternionScalarLast(parts) => {
            let field = format!("{field}.quaternion_scalar_last");
            unit(&field, Quaternion::from_scalar_last(*parts))
        }
        AttitudeFile::Euler321Deg(angles) => {
            let [yaw, pitch, roll] = angles.map(f64::to_radians);
            Ok(Quaternion::from_euler_321(yaw, pitch, roll))
        }
        AttitudeFile::AxisAngle(turn) => {
            let axis = unit_axis(&format!("{field}.axis_angle.axis"), &turn.axis)?;
            let (sine, cosine) = libm::sincos(0.5 * turn.angle_deg.to_radians());
            Ok(Quaternion::new(cosine, axis * sine))
        }
    }
}

fn unit(field: &str, quaternion: Quaternion) -> Result<Quaternion, ModelError> {
    let norm = quaternion.norm();
    let ok = (norm - 1.0).abs() <= NORM_TOLERANCE;
    if !ok {
        let norm = readable(norm);
        let reason =
            format!("the norm of the quaternion is {norm}; it must be 1 (within {NORM_TOLERANCE})");
        return Err(ModelError::choice(field, reason));
    }
    Ok(quaternion.normalised().unwrap_or(quaternion))
}

fn unit_axis(field: &str, axis: &[f64; 3]) -> Result<Vector3<f64>, ModelError> {
    let axis = Vector3::from(*axis);
    let length = axis.norm();
    if length.is_nan() || length <= 0.0 {
        return Err(ModelError::choice(
            field,
            "every entry is 0; an axis needs a direction",
        ));
    }
    Ok(axis / length)
}

fn reference(file: &ReferenceFile) -> Result<Reference, ModelError> {
    Ok(match file {
        ReferenceFile::Constant(fixed) => Reference::Fixed(attitude("reference.constant", fixed)?),
        ReferenceFile::Slew {
            start,
            axis,
            rate_rad_s,
            from_s,
            until_s,
        } => {
            let (from_s, until_s) = (from_s.get(), until_s.get());
            check_window("reference.slew", from_s, until_s)?;
            Reference::Slew {
                start: attitude("reference.slew.start", start)?,
                axis: unit_axis("reference.slew.axis", &plain(axis))?,
                rate_rad_s: rate_rad_s.get(),
                from_s,
                until_s,
            }
        }
        ReferenceFile::Sine {
            centre,
            axis,
            amplitude_deg,
            frequency_rad_s,
        } => Reference::Sine {
            centre: attitude("reference.sine.centre", centre)?,
            axis: unit_axis("reference.sine.axis", &plain(axis))?,
            amplitude_rad: amplitude_deg.get().to_radians(),
            frequency_rad_s: frequency_rad_s.get(),
        },
    })
}

/// The start is checked here too: that of a fault may be sampled.
fn check_window(field: &str, from: f64, until: f64) -> Result<(), ModelError> {
    check_not_negative(&format!("{field}.from_s"), from)?;
    let field = format!("{field}.until_s");
    require(until > from, &field, until, "above from_s")
}

fn torque(file: &TorqueFile) -> Result<Disturbance<3>, ModelError> {
    let harmonics = file.sines.iter().map(|sine| Harmonic {
        frequency_rad_s: sine.frequency_rad_s,
        sine: Vector3::from(sine.sine_nm),
        cosine: Vector3::from(sine.cosine_nm),
    });
    let mut table = DisturbanceTable::default();
    for (index, row) in file.table.iter().enumerate() {
        let field = format!("disturbance.table[{index}].time_s");
        let later = table.times_s.last().is_none_or(|&last| row.time_s > last);
        require(later, &field, row.time_s, "later than in the row before")?;
        table.times_s.push(row.time_s);
        table.values.push(Vector3::from(row.torque_nm));
    }
    Ok(Disturbance {
        bias: Vector3::from(file.bias_nm),
        harmonics: harmonics.collect(),
        table: (!table.times_s.is_empty()).then_some(table),
        pulses: Vec::new(),
        worst: file.worst_nm,
    })
}

impl SensorsFile {
    fn errors(&self) -> Result<SensorErrors, ModelError> {
        let bounded = self.bounded_error.as_ref().map(BoundedErrorFile::bounds);
        Ok(SensorErrors {
            attitude_noise_rad: self.attitude_noise_deg.to_radians(),
            rate_noise_rad_s: self.rate_noise_deg_s.to_radians(),
            attitude_quantum_rad: self.attitude_quantum_deg.to_radians(),
            rate_quantum_rad_s: self.rate_quantum_deg_s.to_radians(),
            bounded: bounded.transpose()?,
        })
    }
}

impl BoundedErrorFile {
    /// The bounds on the rate (rad/s) and on the rotation (rad).
    fn bounds(&self) -> Result<ErrorBounds, ModelError> {
        check_direction("sensors.bounded_error", &self.kind, 6)?;
        let group = |states, bound, scale| ErrorGroup {
            states,
            bound,
            scale,
        };
        Ok(ErrorBounds {
            groups: vec![
                group(0..3, self.rate_rad_s, 1.0),
                group(3..6, self.attitude_deg.to_radians(), 2.0),
            ],
            kind: self.kind.clone(),
        })
    }
}

/// A fault's fraction of the command that acts, and what acts on top.
fn check_fault(field: &str, file: &FaultFile) -> Result<(Fault, Option<Pulse<3>>), ModelError> {
    let ok = (1..=3).contains(&file.axis);
    let axis = format!("{field}.axis");
    require(ok, &axis, f64::from(file.axis), "1, 2 or 3")?;
    check_window(field, file.from_s, file.until_s)?;
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
        Some(wave) => Some(Pulse {
            wave: along(wave.amplitude_nm.get()),
            frequency_rad_s: wave.frequency_rad_s.get(),
            phase_rad: wave.phase_deg.get().to_radians(),
            decay_per_s: wave.decay_per_s.get(),
            ..constant
        }),
    };
    Ok((fault, pulse))
}
