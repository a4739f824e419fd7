//! What a spacecraft is measured by in a run: the errors of its attitude and of its rate.

use std::ops::Range;

use nalgebra::{Matrix6, SVector, Vector3, Vector6};
use runtime::attitude::AttitudeMeasurement;

use super::wheels::{wheeled_state, WheeledBody, WheeledState, Wheels};
use super::{RigidBody, RigidBodyFile, RigidBodySystem};
use crate::sim::bench::{Bench, Gauge};
use crate::sim::metrics::Measured;
use crate::sim::plant::PlantFile;
use crate::sim::pointing::ErrorStatistics;
use crate::sim::reference::Reference;
use crate::sim::rigid_body_state::{body_rate, body_state, rigid_body_state};
use crate::sim::sensor::AttitudeSensor;

/// Columns of the trajectory.
const COLUMNS: [&str; 14] = [
    "error_q0_scalar",
    "error_q1",
    "error_q2",
    "error_q3",
    "rate_1_rad_s",
    "rate_2_rad_s",
    "rate_3_rad_s",
    "torque_1_nm",
    "torque_2_nm",
    "torque_3_nm",
    "disturbance_1_nm",
    "disturbance_2_nm",
    "disturbance_3_nm",
    "error_deg",
];

/// Columns of the trajectory of a spacecraft with wheels: their momentum in body axes.
const WHEEL_COLUMNS: [&str; 3] = [
    "wheel_momentum_1_nms",
    "wheel_momentum_2_nms",
    "wheel_momentum_3_nms",
];

/// What counts as settled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SettleRule {
    /// A rotation angle of at most this, rad.
    Angle(f64),
    /// Components of the error quaternion's vector part of at most this magnitude.
    Component(f64),
}

/// The errors of attitude and rate.
#[derive(Debug, Clone)]
pub struct AttitudeGauge {
    reference: Reference,
    settle: SettleRule,
    /// Square of the largest norm of the body rate, rad^2/s^2.
    rate_squared: f64,
    wheels: Option<Wheels>,
    /// The wheels' momentum in body axes now, N m s.
    momentum: Vector3<f64>,
    /// Its largest norm and components, N m s.
    momentum_peaks: [f64; 4],
}

/// A spacecraft in its surroundings.
pub type AttitudeBench = Bench<RigidBody, AttitudeSensor, AttitudeGauge, 7, 3, 3>;

/// A spacecraft with reaction wheels in its surroundings.
pub type WheeledBench = Bench<WheeledBody, AttitudeSensor, AttitudeGauge, 10, 3, 3>;

impl RigidBodySystem {
    /// The spacecraft without wheels, ready for a run with this seed. `worst`: F'B'U of the design, where there is one.
    pub fn bench(
        &self,
        settle: SettleRule,
        worst: Option<Matrix6<f64>>,
        seed: u64,
    ) -> AttitudeBench {
        Bench {
            plant: self.body,
            initial: rigid_body_state(&self.attitude, &self.rate_rad_s),
            disturbance: self.disturbance.clone(),
            sensor: AttitudeSensor::new(self.reference, self.sensors.clone(), worst, seed),
            actuators: self.actuators.clone(),
            reference_jumps_s: self.reference.discontinuities_s(),
            gauge: AttitudeGauge {
                reference: self.reference,
                settle,
                rate_squared: 0.0,
                wheels: None,
                momentum: Vector3::zeros(),
                momentum_peaks: [0.0; 4],
            },
        }
    }
}

impl AttitudeBench {
    /// The same spacecraft, turned by wheels.
    pub fn with_wheels(self, wheels: Wheels) -> WheeledBench {
        let mut gauge = self.gauge;
        gauge.wheels = Some(wheels);
        Bench {
            plant: WheeledBody {
                body: self.plant,
                wheels,
            },
            initial: wheeled_state(&self.initial, &wheels.initial),
            disturbance: self.disturbance,
            sensor: self.sensor,
            actuators: self.actuators,
            reference_jumps_s: self.reference_jumps_s,
            gauge,
        }
    }
}

impl AttitudeGauge {
    fn wheeled<const N: usize>(&self, state: &SVector<f64, N>) -> Option<(&Wheels, WheeledState)> {
        let wheels = self.wheels.as_ref().filter(|_| N >= 10)?;
        let state = WheeledState::from_fn(|row, _| state.get(row).copied().unwrap_or(0.0));
        Some((wheels, state))
    }
}

fn angle_deg(error: &AttitudeMeasurement) -> f64 {
    error.error.rotation_angle_rad().to_degrees()
}

/// Of the rigid body, whose states are the first, and of its wheels, if the rest is theirs.
impl<const N: usize> Gauge<N, 3, 3, 6> for AttitudeGauge {
    type Seen = AttitudeMeasurement;

    const QUANTITIES: &'static [&'static str] = RigidBodyFile::QUANTITIES;

    #[inline(always)]
    fn see(&self, time_s: f64, state: &SVector<f64, N>) -> AttitudeMeasurement {
        self.reference.error(time_s, &body_state(state))
    }

    #[inline(always)]
    fn watch(&mut self, state: &SVector<f64, N>) {
        let rate = body_rate(&body_state(state));
        self.rate_squared = self.rate_squared.max(rate.norm_squared());
        let Some((wheels, state)) = self.wheeled(state) else {
            return;
        };
        self.momentum = wheels.momentum(&state);
        let [x, y, z] = self.momentum.abs().into();
        let now = [self.momentum.norm(), x, y, z];
        for (peak, value) in self.momentum_peaks.iter_mut().zip(now) {
            *peak = peak.max(value);
        }
    }

    fn momentum_peaks(&self) -> Option<[f64; 4]> {
        self.wheels.map(|_| self.momentum_peaks)
    }

    #[inline(always)]
    fn acting_disturbance(
        &self,
        state: &SVector<f64, N>,
        input: &Vector3<f64>,
        disturbance: &Vector3<f64>,
    ) -> Vector3<f64> {
        match self.wheeled(state) {
            None => *disturbance,
            Some((wheels, state)) => disturbance + wheels.further_torque(&state, input),
        }
    }

    /// The state [rate; vector part] with the sign that makes the scalar part positive.
    #[inline(always)]
    fn certified(&self, seen: &AttitudeMeasurement) -> Vector6<f64> {
        let sign = if seen.error.scalar < 0.0 { -1.0 } else { 1.0 };
        let [[w1, w2, w3]] = seen.rate_rad_s.data.0;
        let [[q1, q2, q3]] = seen.error.vector.data.0;
        Vector6::new(w1, w2, w3, sign * q1, sign * q2, sign * q3)
    }

    fn settle_tolerance(&self) -> f64 {
        match self.settle {
            // |q| = sin(angle / 2).
            SettleRule::Angle(angle_rad) => libm::sin(0.5 * angle_rad),
            SettleRule::Component(tolerance) => tolerance,
        }
    }

    #[inline(always)]
    fn settling_square(&self, seen: &AttitudeMeasurement) -> f64 {
        let vector = &seen.error.vector;
        match self.settle {
            SettleRule::Angle(_) => vector.norm_squared(),
            SettleRule::Component(_) => {
                // A component that is not a number must not vanish in a maximum.
                let largest = vector.amax();
                largest * largest + 0.0 * vector.sum()
            }
        }
    }

    /// The rotation angle, rad.
    #[inline(always)]
    fn tail_square(&self, seen: &AttitudeMeasurement) -> f64 {
        let angle = seen.error.rotation_angle_rad();
        angle * angle
    }

    fn quantities(&self, seen: &AttitudeMeasurement) -> Vec<f64> {
        vec![angle_deg(seen), seen.rate_rad_s.norm()]
    }

    fn columns(&self) -> Vec<String> {
        let wheels = self.wheels.iter().flat_map(|_| WHEEL_COLUMNS);
        COLUMNS
            .into_iter()
            .chain(wheels)
            .map(str::to_string)
            .collect()
    }

    fn inputs(&self) -> Range<usize> {
        7..10
    }

    fn disturbances(&self) -> Range<usize> {
        10..13
    }

    fn write(
        &self,
        seen: &AttitudeMeasurement,
        torque: &Vector3<f64>,
        disturbance: &Vector3<f64>,
        row: &mut Vec<f64>,
    ) {
        row.extend(seen.error.to_scalar_first());
        for vector in [&seen.rate_rad_s, torque, disturbance] {
            row.extend(vector.iter());
        }
        row.push(angle_deg(seen));
        if self.wheels.is_some() {
            row.extend(self.momentum.iter());
        }
    }

    fn measure(
        &self,
        error: &ErrorStatistics,
        last: &AttitudeMeasurement,
        measured: &mut Measured,
    ) {
        let finite = |value: f64| Some(value).filter(|value| value.is_finite());
        let degrees = |angle: f64| finite(angle.to_degrees());
        measured.final_error_deg = finite(angle_deg(last));
        measured.rms_error_deg = error.tail_rms().and_then(degrees);
        measured.tail_error_deg = error.tail_peak().and_then(degrees);
        measured.max_rate = finite(self.rate_squared.sqrt());
    }
}
