//! Sensors: from the plant's state to what the controller sees.

use nalgebra::{Matrix6, SVector, Vector3};
use runtime::attitude::{AttitudeMeasurement, Quaternion};

use super::measurement_error::{BoundedError, ErrorBounds};
use super::random::{Purpose, Random};
use super::reference::Reference;
use super::rigid_body_state::body_state;

/// A sensor of a plant with `N` states.
pub trait Sensor<const N: usize> {
    /// What it measures.
    type Measurement: Copy;

    /// The measurement of a state at `time_s` seconds.
    fn measure(&mut self, time_s: f64, state: &SVector<f64, N>) -> Self::Measurement;

    /// The last measurement was sent.
    fn sent(&mut self, _measurement: &Self::Measurement) {}

    /// The largest errors so far: of the rate (norm, rad/s) and of the attitude (angle, rad), or of each state; none of a
    /// perfect sensor.
    fn largest_errors(&self) -> &[f64] {
        &[]
    }
}

/// Errors of attitude and rate sensors; all zero for perfect ones.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SensorErrors {
    /// Standard deviation of the attitude about each axis, rad.
    pub attitude_noise_rad: f64,
    /// Standard deviation of each rate, rad/s.
    pub rate_noise_rad_s: f64,
    /// Resolution of the attitude, rad; zero for none.
    pub attitude_quantum_rad: f64,
    /// Resolution of each rate, rad/s; zero for none.
    pub rate_quantum_rad_s: f64,
    /// Bounded errors of rate (rad/s) and attitude (rad).
    pub bounded: Option<ErrorBounds>,
}

impl SensorErrors {
    /// True when every measurement is exact.
    pub fn is_perfect(&self) -> bool {
        *self == Self::default()
    }
}

/// Attitude and rate sensors of the rigid body, with respect to a reference.
#[derive(Clone, Debug)]
pub struct AttitudeSensor {
    reference: Reference,
    errors: SensorErrors,
    perfect: bool,
    bounded: Option<BoundedError<6>>,
    largest: [f64; 2],
    random: Random,
}

impl AttitudeSensor {
    /// Sensor with the noise of a scenario's seed. `worst`: F'B'U of the design, where there is one.
    pub fn new(
        reference: Reference,
        errors: SensorErrors,
        worst: Option<Matrix6<f64>>,
        seed: u64,
    ) -> Self {
        let bounded = errors.bounded.clone();
        Self {
            reference,
            perfect: errors.is_perfect(),
            bounded: bounded.map(|bounds| BoundedError::new(bounds, worst, seed)),
            errors,
            largest: [0.0; 2],
            random: Random::new(seed, Purpose::Noise),
        }
    }

    /// Adds the bounded error: to the rate, and a small rotation to the attitude.
    fn displace(&mut self, exact: AttitudeMeasurement) -> AttitudeMeasurement {
        let Some(bounded) = &mut self.bounded else {
            return exact;
        };
        let error = bounded.error(&exact.rigid_body_state());
        let attitude = exact.error.shortest();
        let mut turn = error.fixed_rows::<3>(3).into_owned();
        let angle = turn.norm();
        if bounded.follows_state() {
            // A rotation t changes the vector part by (q0 t + q x t) / 2.
            turn = turn * attitude.scalar - attitude.vector.cross(&turn);
        }
        let turn = Quaternion::from_axis_angle(&turn, angle).unwrap_or(Quaternion::identity());
        AttitudeMeasurement {
            error: attitude * turn,
            rate_rad_s: exact.rate_rad_s + error.fixed_rows::<3>(0),
        }
    }

    /// Takes the errors of a measurement.
    fn compare(&mut self, exact: &AttitudeMeasurement, measured: &AttitudeMeasurement) {
        let rate = (measured.rate_rad_s - exact.rate_rad_s).norm();
        let angle = measured.error.error_from(&exact.error).rotation_angle_rad();
        self.largest = [self.largest[0].max(rate), self.largest[1].max(angle)];
    }

    fn spoil(&mut self, exact: AttitudeMeasurement) -> AttitudeMeasurement {
        let errors = &self.errors;
        let [attitude_noise_rad, rate_noise_rad_s] =
            [errors.attitude_noise_rad, errors.rate_noise_rad_s];
        let [attitude_quantum_rad, rate_quantum_rad_s] =
            [errors.attitude_quantum_rad, errors.rate_quantum_rad_s];
        let mut error = exact.error;
        let mut rate = exact.rate_rad_s;
        if attitude_noise_rad > 0.0 {
            let half = self.normal_vector() * (0.5 * attitude_noise_rad);
            error = error * Quaternion::new(1.0, half);
        }
        if rate_noise_rad_s > 0.0 {
            rate += self.normal_vector() * rate_noise_rad_s;
        }
        if attitude_quantum_rad > 0.0 {
            let grid = 0.5 * attitude_quantum_rad;
            error.vector = error.vector.map(|value| round_to(value, grid));
        }
        if rate_quantum_rad_s > 0.0 {
            rate = rate.map(|value| round_to(value, rate_quantum_rad_s));
        }
        AttitudeMeasurement {
            error: error.normalised().unwrap_or(error),
            rate_rad_s: rate,
        }
    }

    fn normal_vector(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.random.normal())
    }
}

fn round_to(value: f64, grid: f64) -> f64 {
    (value / grid).round() * grid
}

/// The first states are those of the rigid body.
impl<const N: usize> Sensor<N> for AttitudeSensor {
    type Measurement = AttitudeMeasurement;

    #[inline]
    fn measure(&mut self, time_s: f64, state: &SVector<f64, N>) -> AttitudeMeasurement {
        let exact = self.reference.error(time_s, &body_state(state));
        if self.perfect {
            return exact;
        }
        let displaced = self.displace(exact);
        let measured = self.spoil(displaced);
        self.compare(&exact, &measured);
        measured
    }

    fn sent(&mut self, measurement: &AttitudeMeasurement) {
        if let Some(bounded) = &mut self.bounded {
            bounded.sent(&measurement.rigid_body_state());
        }
    }

    fn largest_errors(&self) -> &[f64] {
        match self.perfect {
            true => &[],
            false => &self.largest,
        }
    }
}

/// Measures the whole state, with the same noise on each of its first components.
#[derive(Clone, Debug)]
pub struct StateSensor<const N: usize> {
    /// Number of components that are measured; the rest is padding.
    pub states: usize,
    /// Standard deviation, in units of the state.
    pub noise: f64,
    bounded: Option<BoundedError<N>>,
    largest: SVector<f64, N>,
    random: Random,
}

impl<const N: usize> StateSensor<N> {
    /// Sensor of `states` components with the noise of a scenario's seed.
    pub fn new(states: usize, noise: f64, seed: u64) -> Self {
        Self {
            states,
            noise,
            bounded: None,
            largest: SVector::zeros(),
            random: Random::new(seed, Purpose::Noise),
        }
    }

    /// The same sensor with a bounded error beside its noise.
    pub fn with_error(self, bounded: BoundedError<N>) -> Self {
        Self {
            bounded: Some(bounded),
            ..self
        }
    }

    fn is_perfect(&self) -> bool {
        self.noise == 0.0 && self.bounded.is_none()
    }
}

impl<const N: usize> Sensor<N> for StateSensor<N> {
    type Measurement = SVector<f64, N>;

    fn sent(&mut self, measurement: &SVector<f64, N>) {
        if let Some(bounded) = &mut self.bounded {
            bounded.sent(measurement);
        }
    }

    fn largest_errors(&self) -> &[f64] {
        match self.is_perfect() {
            true => &[],
            false => &self.largest.as_slice()[..self.states],
        }
    }

    fn measure(&mut self, _time_s: f64, state: &SVector<f64, N>) -> SVector<f64, N> {
        let mut measured = *state;
        if let Some(bounded) = &mut self.bounded {
            measured += bounded.error(state);
        }
        if self.noise > 0.0 {
            for value in measured.iter_mut().take(self.states) {
                *value += self.noise * self.random.normal();
            }
        }
        if !self.is_perfect() {
            self.largest = self.largest.sup(&(measured - state).abs());
        }
        measured
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::rigid_body_state::rigid_body_state;

    fn spread(errors: SensorErrors) -> (f64, f64) {
        let reference = Reference::Fixed(Quaternion::identity());
        let mut sensor = AttitudeSensor::new(reference, errors, None, 7);
        let state = rigid_body_state(
            &Quaternion::from_euler_321(0.2, 0.1, -0.4),
            &Vector3::new(0.01, -0.02, 0.03),
        );
        let exact = reference.error(0.0, &state);
        let count = 20_000;
        let (mut angles, mut rates) = (0.0, 0.0);
        for _ in 0..count {
            let measured = sensor.measure(0.0, &state);
            let turned = measured.error.error_from(&exact.error).rotation_angle_rad();
            angles += turned * turned / 3.0;
            rates += (measured.rate_rad_s - exact.rate_rad_s).norm_squared() / 3.0;
        }
        let mean = |sum: f64| (sum / f64::from(count)).sqrt();
        (mean(angles), mean(rates))
    }

    #[test]
    fn noise_has_the_standard_deviation_asked_for_about_each_axis() {
        let (angle, rate) = spread(SensorErrors {
            attitude_noise_rad: 3e-5,
            rate_noise_rad_s: 4e-6,
            ..SensorErrors::default()
        });
        // 60,000 normal numbers: a relative standard deviation of 0.3 %.
        assert!((angle / 3e-5 - 1.0).abs() < 0.015, "{angle}");
        assert!((rate / 4e-6 - 1.0).abs() < 0.015, "{rate}");
    }

    #[test]
    fn a_quantised_measurement_is_off_by_half_a_quantum_at_most() {
        let (angle, rate) = spread(SensorErrors {
            attitude_quantum_rad: 1e-3,
            rate_quantum_rad_s: 1e-3,
            ..SensorErrors::default()
        });
        assert!(angle > 0.0 && angle < 0.7e-3, "{angle}");
        assert!(rate < 0.5e-3, "{rate}");
    }
}
