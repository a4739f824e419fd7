//! Error transform, terminal sliding surface and control law: (14) to (20).

use nalgebra::{Matrix3, Vector3};

use super::envelope::{sign, Bounds};
use crate::error::{AllowedRange, ParameterError};

/// Closest the error counts to a bound, as a share of the envelope's width: at a bound (14) is
/// infinite. An error outside counts as this close inside.
const EDGE: f64 = 1e-6;

/// Gains of the law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// k1, rad/s, positive: gain of the transformed error in the sliding variable.
    pub surface_gain: f64,
    /// p/q, dimensionless, in (1, 2): exponent of the transformed error. The published p = 3, q = 5
    /// are the wrong way round: below 1 the law is singular where the transformed error is zero.
    pub surface_exponent: f64,
    /// k2, N m s/rad, positive.
    pub linear_gain: f64,
    /// k3, N m (s/rad)^chi, positive.
    pub power_gain: f64,
    /// chi, dimensionless, in (0, 1).
    pub power_exponent: f64,
    /// zeta of each axis, rad/s, not negative: a smaller sliding variable is left alone.
    pub dead_zone_rad_s: Vector3<f64>,
}

impl Gains {
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let positive = |name, value| AllowedRange::POSITIVE.check_scalar(name, value);
        positive("surface_gain", self.surface_gain)?;
        AllowedRange::open(1.0, 2.0).check_scalar("surface_exponent", self.surface_exponent)?;
        positive("linear_gain", self.linear_gain)?;
        positive("power_gain", self.power_gain)?;
        AllowedRange::open(0.0, 1.0).check_scalar("power_exponent", self.power_exponent)?;
        AllowedRange::NON_NEGATIVE.check_vector("dead_zone_rad_s", &self.dead_zone_rad_s)
    }

    /// The vector part of the error quaternion at which an axis comes to rest when its envelope has
    /// half width `level`: there the dead zone is all of the sliding variable.
    pub fn steady_error(&self, axis: usize, level: f64) -> Option<f64> {
        let zone = self.dead_zone_rad_s.get(axis)?;
        let transformed = libm::pow(zone / self.surface_gain, 1.0 / self.surface_exponent);
        Some(level * libm::tanh(0.5 * transformed))
    }
}

/// (14): the error without bounds, and its derivative.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TransformedError {
    /// epsilon, dimensionless.
    pub value: f64,
    /// Its time derivative, 1/s; zero outside of the envelope, where (15) has no meaning.
    pub slope: f64,
    /// Whether the error was between the bounds.
    pub inside: bool,
}

impl TransformedError {
    /// Of an error and its rate between bounds: (14), and (15) with its minus signs.
    pub fn new(error: f64, rate: f64, bounds: &Bounds) -> Self {
        let (lower, upper) = (&bounds.lower, &bounds.upper);
        let edge = EDGE * (upper.value - lower.value);
        let (above, below) = (error - lower.value, upper.value - error);
        let inside = above > 0.0 && below > 0.0;
        let (above, below) = (above.max(edge), below.max(edge));
        Self {
            value: libm::log(above / below),
            slope: if inside {
                (rate - lower.slope) / above - (upper.slope - rate) / below
            } else {
                0.0
            },
            inside,
        }
    }
}

/// What the law needs to know about a sample. Vectors are in body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// omega, rad/s.
    pub rate: Vector3<f64>,
    /// omega_e, rad/s.
    pub rate_error: Vector3<f64>,
    /// C omega_d, rad/s.
    pub desired_rate: Vector3<f64>,
    /// C omega_d', rad/s^2.
    pub desired_acceleration: Vector3<f64>,
}

/// (16): the sliding variable, rad/s.
pub fn sliding_variable(
    gains: &Gains,
    errors: &[TransformedError; 3],
    rate_error: &Vector3<f64>,
) -> Vector3<f64> {
    let attitude =
        errors.map(|error| gains.surface_gain * signed_power(error.value, gains.surface_exponent));
    Vector3::from(attitude) + rate_error
}

/// (20): the torque about the body axes that the law asks for, N m, not limited.
pub fn torque(
    gains: &Gains,
    inertia: &Matrix3<f64>,
    errors: &[TransformedError; 3],
    sliding: &Vector3<f64>,
    motion: &Motion,
    fault: &Vector3<f64>,
) -> Vector3<f64> {
    let exponent = gains.surface_exponent;
    let along_surface = Vector3::from(errors.map(|error| {
        let slope = libm::pow(error.value.abs(), exponent - 1.0) * error.slope;
        gains.surface_gain * exponent * slope
    }));
    let transport = motion.rate_error.cross(&motion.desired_rate) - motion.desired_acceleration;
    let gyroscopic = motion.rate.cross(&(inertia * motion.rate));
    let reaching = sliding.zip_map(&gains.dead_zone_rad_s, |value, zone| {
        if value.abs() < zone {
            0.0
        } else {
            gains.linear_gain * value + gains.power_gain * signed_power(value, gains.power_exponent)
        }
    });
    gyroscopic - inertia * (transport + along_surface) - fault - reaching
}

/// sig(value)^exponent.
fn signed_power(value: f64, exponent: f64) -> f64 {
    sign(value) * libm::pow(value.abs(), exponent)
}
