//! Sensors: from the plant's state to what the controller sees.

use nalgebra::{SVector, Vector3};
use runtime::attitude::{AttitudeMeasurement, Quaternion};

use super::random::{Purpose, Random};
use super::reference::Reference;
use super::rigid_body_state::RigidBodyState;

/// A sensor of a plant with `N` states.
pub trait Sensor<const N: usize> {
    /// What it measures.
    type Measurement: Copy;

    /// The measurement of a state at `time_s` seconds.
    fn measure(&mut self, time_s: f64, state: &SVector<f64, N>) -> Self::Measurement;
}

/// Errors of attitude and rate sensors; all zero for perfect ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SensorErrors {
    /// Standard deviation of the attitude about each axis, rad.
    pub attitude_noise_rad: f64,
    /// Standard deviation of each rate, rad/s.
    pub rate_noise_rad_s: f64,
    /// Resolution of the attitude, rad; zero for none.
    pub attitude_quantum_rad: f64,
    /// Resolution of each rate, rad/s; zero for none.
    pub rate_quantum_rad_s: f64,
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
    random: Random,
}

impl AttitudeSensor {
    /// Sensor with the noise of a scenario's seed.
    pub fn new(reference: Reference, errors: SensorErrors, seed: u64) -> Self {
        Self {
            reference,
            errors,
            perfect: errors.is_perfect(),
            random: Random::new(seed, Purpose::Noise),
        }
    }

    fn spoil(&mut self, exact: AttitudeMeasurement) -> AttitudeMeasurement {
        let errors = self.errors;
        let mut error = exact.error;
        let mut rate = exact.rate_rad_s;
        if errors.attitude_noise_rad > 0.0 {
            let half = self.normal_vector() * (0.5 * errors.attitude_noise_rad);
            error = error * Quaternion::new(1.0, half);
        }
        if errors.rate_noise_rad_s > 0.0 {
            rate += self.normal_vector() * errors.rate_noise_rad_s;
        }
        if errors.attitude_quantum_rad > 0.0 {
            let grid = 0.5 * errors.attitude_quantum_rad;
            error.vector = error.vector.map(|value| round_to(value, grid));
        }
        if errors.rate_quantum_rad_s > 0.0 {
            rate = rate.map(|value| round_to(value, errors.rate_quantum_rad_s));
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

impl Sensor<7> for AttitudeSensor {
    type Measurement = AttitudeMeasurement;

    #[inline]
    fn measure(&mut self, time_s: f64, state: &RigidBodyState) -> AttitudeMeasurement {
        let exact = self.reference.error(time_s, state);
        if self.perfect {
            exact
        } else {
            self.spoil(exact)
        }
    }
}

/// Measures the whole state, with the same noise on each of its first components.
#[derive(Clone, Debug)]
pub struct StateSensor {
    /// Number of components that are measured; the rest is padding.
    pub states: usize,
    /// Standard deviation, in units of the state.
    pub noise: f64,
    random: Random,
}

impl StateSensor {
    /// Sensor of `states` components with the noise of a scenario's seed.
    pub fn new(states: usize, noise: f64, seed: u64) -> Self {
        Self {
            states,
            noise,
            random: Random::new(seed, Purpose::Noise),
        }
    }
}

impl<const N: usize> Sensor<N> for StateSensor {
    type Measurement = SVector<f64, N>;

    fn measure(&mut self, _time_s: f64, state: &SVector<f64, N>) -> SVector<f64, N> {
        let mut measured = *state;
        if self.noise > 0.0 {
            for value in measured.iter_mut().take(self.states) {
                *value += self.noise * self.random.normal();
            }
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
        let mut sensor = AttitudeSensor::new(reference, errors, 7);
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
