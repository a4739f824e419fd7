//! Reference attitudes in time.

use nalgebra::Vector3;
use runtime::attitude::{AttitudeMeasurement, Quaternion};

use super::rigid_body_state::{attitude, body_rate, RigidBodyState};

/// What the attitude should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reference {
    /// A constant attitude.
    Fixed(Quaternion),
    /// A turn at a constant rate from one attitude, about an axis fixed in the body.
    Slew {
        /// Attitude before the slew.
        start: Quaternion,
        /// Unit axis.
        axis: Vector3<f64>,
        /// Rate, rad/s.
        rate_rad_s: f64,
        /// Start of the slew, s.
        from_s: f64,
        /// End of the slew, s.
        until_s: f64,
    },
    /// An oscillation about an axis fixed in the body.
    Sine {
        /// Attitude in the middle.
        centre: Quaternion,
        /// Unit axis.
        axis: Vector3<f64>,
        /// Amplitude, rad.
        amplitude_rad: f64,
        /// Angular frequency, rad/s.
        frequency_rad_s: f64,
    },
}

impl Reference {
    /// True when it never changes.
    pub fn is_fixed(&self) -> bool {
        matches!(self, Reference::Fixed(_))
    }

    /// Times at which its rate jumps, s.
    pub fn discontinuities_s(&self) -> Vec<f64> {
        match *self {
            Reference::Slew {
                from_s, until_s, ..
            } => vec![from_s, until_s],
            _ => Vec::new(),
        }
    }

    /// Desired attitude and desired rate (rad/s, in the desired frame) at `time_s` seconds.
    pub fn at(&self, time_s: f64) -> (Quaternion, Vector3<f64>) {
        match *self {
            Reference::Fixed(attitude) => (attitude, Vector3::zeros()),
            Reference::Slew {
                start,
                axis,
                rate_rad_s,
                from_s,
                until_s,
            } => {
                let moving = time_s >= from_s && time_s < until_s;
                let angle = rate_rad_s * (time_s.clamp(from_s, until_s) - from_s);
                let rate = if moving { rate_rad_s } else { 0.0 };
                (start * turn(&axis, angle), axis * rate)
            }
            Reference::Sine {
                centre,
                axis,
                amplitude_rad,
                frequency_rad_s,
            } => {
                let (sine, cosine) = libm::sincos(frequency_rad_s * time_s);
                let rate = amplitude_rad * frequency_rad_s * cosine;
                (centre * turn(&axis, amplitude_rad * sine), axis * rate)
            }
        }
    }

    /// Time derivative of the desired rate, rad/s^2, in the desired frame; not the jumps at
    /// [`Self::discontinuities_s`].
    pub fn acceleration(&self, time_s: f64) -> Vector3<f64> {
        match *self {
            Reference::Fixed(_) | Reference::Slew { .. } => Vector3::zeros(),
            Reference::Sine {
                axis,
                amplitude_rad,
                frequency_rad_s,
                ..
            } => {
                let square = frequency_rad_s * frequency_rad_s;
                axis * (-amplitude_rad * square * libm::sin(frequency_rad_s * time_s))
            }
        }
    }

    /// The attitude and rate errors of a state, without sensor errors.
    #[inline(always)]
    pub fn error(&self, time_s: f64, state: &RigidBodyState) -> AttitudeMeasurement {
        match self {
            Reference::Fixed(desired) => fixed_error(desired, state),
            _ => self.moving_error(time_s, state),
        }
    }

    #[inline(never)]
    fn moving_error(&self, time_s: f64, state: &RigidBodyState) -> AttitudeMeasurement {
        let (desired, desired_rate) = self.at(time_s);
        let error = attitude(state).error_from(&desired);
        AttitudeMeasurement {
            error,
            rate_rad_s: error.rate_error(&body_rate(state), &desired_rate),
        }
    }
}

/// The conjugate of `desired` times the attitude, written out: every step of every run needs it.
#[inline(always)]
fn fixed_error(desired: &Quaternion, state: &RigidBodyState) -> AttitudeMeasurement {
    let [[w1, w2, w3, q0, q1, q2, q3]] = state.data.0;
    let (d0, [[d1, d2, d3]]) = (desired.scalar, desired.vector.data.0);
    AttitudeMeasurement {
        error: Quaternion {
            scalar: d0 * q0 + (d1 * q1 + d2 * q2 + d3 * q3),
            vector: Vector3::new(
                d0 * q1 - d1 * q0 - (d2 * q3 - d3 * q2),
                d0 * q2 - d2 * q0 - (d3 * q1 - d1 * q3),
                d0 * q3 - d3 * q0 - (d1 * q2 - d2 * q1),
            ),
        },
        rate_rad_s: Vector3::new(w1, w2, w3),
    }
}

fn turn(unit_axis: &Vector3<f64>, angle_rad: f64) -> Quaternion {
    let (sine, cosine) = libm::sincos(0.5 * angle_rad);
    Quaternion::new(cosine, unit_axis * sine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_from_a_fixed_attitude_is_that_of_the_attitude_algebra() {
        let desired = Quaternion::from_euler_321(0.3, -0.2, 0.1);
        let actual = Quaternion::from_euler_321(-1.0, 0.5, 2.0);
        let state =
            crate::sim::rigid_body_state::rigid_body_state(&actual, &Vector3::new(1.0, 2.0, 3.0));
        let measured = Reference::Fixed(desired).error(0.0, &state);
        let expected = actual.error_from(&desired);
        assert!((measured.error.scalar - expected.scalar).abs() < 1e-15);
        assert!((measured.error.vector - expected.vector).amax() < 1e-15);
        assert_eq!(measured.rate_rad_s, Vector3::new(1.0, 2.0, 3.0));
    }

    #[test]
    fn the_desired_rate_is_the_derivative_of_the_desired_attitude() {
        let start = Quaternion::from_euler_321(0.3, -0.2, 0.1);
        let axis = Vector3::new(0.6, 0.0, 0.8);
        let references = [
            Reference::Slew {
                start,
                axis,
                rate_rad_s: 0.02,
                from_s: 1.0,
                until_s: 9.0,
            },
            Reference::Sine {
                centre: start,
                axis,
                amplitude_rad: 0.3,
                frequency_rad_s: 0.7,
            },
        ];
        for reference in references {
            let (here, rate) = reference.at(4.0);
            let step = 1e-5;
            let (next, _) = reference.at(4.0 + step);
            let (last, _) = reference.at(4.0 - step);
            let difference = (next.vector - last.vector) / (2.0 * step);
            assert!((difference - here.derivative(&rate).vector).amax() < 1e-9);
        }
    }
}
