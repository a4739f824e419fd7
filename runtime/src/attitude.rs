//! Attitude algebra: quaternions, their kinematics and rotation matrices.
//!
//! A quaternion here rotates the reference frame into the body frame and multiplies in Hamilton's
//! convention, so that `q' = 1/2 q (0, omega)` with the rate `omega` in the body frame. Where
//! numbers enter or leave as a plain array, the method's name says which component is the scalar.

use core::ops::{Mul, Neg};

use nalgebra::{Matrix3, Vector3, Vector6};
use thiserror::Error;

use crate::command::HoldReason;
use crate::error::{AllowedRange, ParameterError};

/// Largest difference from 1 of the norm of a quaternion that still counts as an attitude
/// measurement. Sensor noise and published values printed to four digits stay far below; a sensor
/// that returns zeros does not.
pub const NORM_TOLERANCE: f64 = 1e-2;

/// The quaternion `scalar + vector`, dimensionless. An attitude has norm 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quaternion {
    /// Scalar part q0: the cosine of half the rotation angle.
    pub scalar: f64,
    /// Vector part q: the rotation axis times the sine of half the rotation angle.
    pub vector: Vector3<f64>,
}

impl Quaternion {
    /// No rotation.
    pub fn identity() -> Self {
        Self::new(1.0, Vector3::zeros())
    }

    /// Quaternion of the given parts; nothing is normalised.
    pub fn new(scalar: f64, vector: Vector3<f64>) -> Self {
        Self { scalar, vector }
    }

    /// Quaternion from `[q0, q1, q2, q3]`.
    pub fn from_scalar_first([q0, q1, q2, q3]: [f64; 4]) -> Self {
        Self::new(q0, Vector3::new(q1, q2, q3))
    }

    /// Quaternion from `[q1, q2, q3, q0]`.
    pub fn from_scalar_last([q1, q2, q3, q0]: [f64; 4]) -> Self {
        Self::new(q0, Vector3::new(q1, q2, q3))
    }

    /// The components as `[q0, q1, q2, q3]`.
    pub fn to_scalar_first(self) -> [f64; 4] {
        let [[q1, q2, q3]] = self.vector.data.0;
        [self.scalar, q1, q2, q3]
    }

    /// The components as `[q1, q2, q3, q0]`.
    pub fn to_scalar_last(self) -> [f64; 4] {
        let [[q1, q2, q3]] = self.vector.data.0;
        [q1, q2, q3, self.scalar]
    }

    /// Attitude reached by turning `angle_rad` radians about `axis`, which need not be a unit vector.
    ///
    /// # Errors
    /// [`NormError`] when the axis has no direction or the angle is not finite.
    pub fn from_axis_angle(axis: &Vector3<f64>, angle_rad: f64) -> Result<Self, NormError> {
        let length = libm::sqrt(axis.dot(axis));
        if !(length > 0.0 && length.is_finite() && angle_rad.is_finite()) {
            return Err(NormError { norm: length });
        }
        let half = 0.5 * angle_rad;
        Ok(Self::new(
            libm::cos(half),
            axis * (libm::sin(half) / length),
        ))
    }

    /// Attitude reached by yaw about axis 3, then pitch about the new axis 2, then roll about the
    /// new axis 1 (the 3-2-1 sequence). Angles in radians.
    pub fn from_euler_321(yaw_rad: f64, pitch_rad: f64, roll_rad: f64) -> Self {
        let about = |angle: f64, unit: Vector3<f64>| {
            Self::new(libm::cos(0.5 * angle), unit * libm::sin(0.5 * angle))
        };
        about(yaw_rad, Vector3::new(0.0, 0.0, 1.0))
            * about(pitch_rad, Vector3::new(0.0, 1.0, 0.0))
            * about(roll_rad, Vector3::new(1.0, 0.0, 0.0))
    }

    /// True when every component is finite.
    pub fn is_finite(&self) -> bool {
        self.scalar.is_finite() && self.vector.iter().all(|value| value.is_finite())
    }

    /// Euclidean norm of the four components.
    pub fn norm(&self) -> f64 {
        libm::sqrt(self.scalar * self.scalar + self.vector.dot(&self.vector))
    }

    /// The quaternion scaled to unit norm.
    ///
    /// # Errors
    /// [`NormError`] when the norm is zero, so small that its square underflows, or not finite.
    pub fn normalised(&self) -> Result<Self, NormError> {
        let norm = self.norm();
        if norm >= f64::MIN_POSITIVE && norm.is_finite() {
            Ok(Self::new(self.scalar / norm, self.vector / norm))
        } else {
            Err(NormError { norm })
        }
    }

    /// Conjugate; the inverse rotation of a unit quaternion.
    pub fn conjugate(&self) -> Self {
        Self::new(self.scalar, -self.vector)
    }

    /// Error quaternion of this attitude with respect to `desired`: the conjugate of `desired`
    /// times this one. The identity, up to sign, when both are the same attitude.
    pub fn error_from(&self, desired: &Self) -> Self {
        desired.conjugate() * *self
    }

    /// The same attitude with a scalar part that is not negative.
    pub fn shortest(&self) -> Self {
        if self.scalar < 0.0 {
            -*self
        } else {
            *self
        }
    }

    /// Time derivative, 1/s, at the body rate `rate_rad_s` in rad/s (in body axes): Xu and Huang
    /// 2020, (1) and (2).
    pub fn derivative(&self, rate_rad_s: &Vector3<f64>) -> Self {
        Self::new(
            -0.5 * self.vector.dot(rate_rad_s),
            (rate_rad_s * self.scalar + self.vector.cross(rate_rad_s)) * 0.5,
        )
    }

    /// Rotation angle in radians, from 0 to pi, the shorter way round; accurate at small angles.
    /// The norm does not matter.
    pub fn rotation_angle_rad(&self) -> f64 {
        2.0 * libm::atan2(libm::sqrt(self.vector.dot(&self.vector)), self.scalar.abs())
    }

    /// Rotation matrix (3x3) that takes components in the reference frame to the body frame:
    /// `(q0^2 - q'q) I + 2 q q' - 2 q0 skew(q)`. The quaternion must have unit norm.
    pub fn direction_cosine_matrix(&self) -> Matrix3<f64> {
        let (q0, q) = (self.scalar, &self.vector);
        Matrix3::identity() * (q0 * q0 - q.dot(q)) + q * q.transpose() * 2.0 - skew(q) * (2.0 * q0)
    }

    /// Rate error in rad/s in body axes, when this is the error quaternion: the body rate minus the
    /// desired rate (rad/s, in the desired frame) turned into body axes.
    pub fn rate_error(
        &self,
        rate_rad_s: &Vector3<f64>,
        desired_rate_rad_s: &Vector3<f64>,
    ) -> Vector3<f64> {
        rate_rad_s - self.direction_cosine_matrix() * desired_rate_rad_s
    }
}

/// Hamilton product.
impl Mul for Quaternion {
    type Output = Self;

    fn mul(self, right: Self) -> Self {
        Self::new(
            self.scalar * right.scalar - self.vector.dot(&right.vector),
            right.vector * self.scalar
                + self.vector * right.scalar
                + self.vector.cross(&right.vector),
        )
    }
}

/// The other quaternion of the same attitude.
impl Neg for Quaternion {
    type Output = Self;

    fn neg(self) -> Self {
        Self::new(-self.scalar, -self.vector)
    }
}

/// Skew-symmetric matrix (3x3) of a vector: `skew(a) b` is the cross product of `a` and `b`.
pub fn skew(vector: &Vector3<f64>) -> Matrix3<f64> {
    let [[x, y, z]] = vector.data.0;
    Matrix3::new(0.0, -z, y, z, 0.0, -x, -y, x, 0.0)
}

/// A quaternion or axis cannot be normalised.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("norm {norm} gives no direction")]
pub struct NormError {
    /// Its norm.
    pub norm: f64,
}

/// An attitude measurement: the error from the reference attitude and the rate error.
///
/// Components count, in [`HoldReason::NonFiniteMeasurement`], as q0, q1, q2, q3, omega1, omega2,
/// omega3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttitudeMeasurement {
    /// Error quaternion, of norm 1 up to [`NORM_TOLERANCE`].
    pub error: Quaternion,
    /// Rate error in body axes, rad/s.
    pub rate_rad_s: Vector3<f64>,
}

impl AttitudeMeasurement {
    /// State of Xu and Huang 2020, section 2: the rate in rad/s, then the vector part of the error
    /// quaternion, with the sign for which its scalar part is not negative (their Remark 1).
    ///
    /// The sign is that of the measured scalar part, so a sensor may return either quaternion of an attitude. When the
    /// measured attitude is off by an angle a (rad) and the true scalar part is above 2 sin(a/4), both signs agree, and
    /// the vector part is off by at most 2 sin(a/4) <= a/2.
    pub fn rigid_body_state(&self) -> Vector6<f64> {
        let [[w1, w2, w3]] = self.rate_rad_s.data.0;
        let [[q1, q2, q3]] = self.error.shortest().vector.data.0;
        Vector6::new(w1, w2, w3, q1, q2, q3)
    }

    /// [`Self::rigid_body_state`] of a measurement that can be used.
    ///
    /// # Errors
    /// As [`Self::check`].
    pub fn checked_state(&self) -> Result<Vector6<f64>, HoldReason> {
        self.check()?;
        Ok(self.rigid_body_state())
    }

    /// Checks that the measurement is finite and its quaternion an attitude.
    ///
    /// # Errors
    /// The reason why a controller must not use it.
    pub fn check(&self) -> Result<(), HoldReason> {
        let scalar = core::iter::once(&self.error.scalar);
        let attitude = scalar.chain(self.error.vector.iter());
        HoldReason::check_finite(0, attitude.chain(self.rate_rad_s.iter()))?;
        let norm = self.error.norm();
        if (norm - 1.0).abs() <= NORM_TOLERANCE {
            Ok(())
        } else {
            Err(HoldReason::NotUnitQuaternion { norm })
        }
    }
}

/// Sign of a quaternion's scalar part with hysteresis, so that noise near a half turn does not make
/// the shortest rotation change sides at every sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignHysteresis {
    half_width: f64,
    positive: Option<bool>,
}

impl SignHysteresis {
    /// The sign changes only when the scalar part has passed zero by more than `half_width`
    /// (dimensionless, in `[0, 1)`).
    ///
    /// # Errors
    /// A half width that is not finite or outside of `[0, 1)`.
    pub fn new(half_width: f64) -> Result<Self, ParameterError> {
        AllowedRange::half_open(0.0, 1.0).check_scalar("hysteresis", half_width)?;
        Ok(Self {
            half_width,
            positive: None,
        })
    }

    /// Takes the next scalar part and returns the sign, 1 or -1. The first call takes the sign as it
    /// is, with the sign of zero positive. A value that is not a number leaves the sign as it was.
    pub fn update(&mut self, scalar: f64) -> f64 {
        let positive = match self.positive {
            known if scalar.is_nan() => known.unwrap_or(true),
            None => scalar >= 0.0,
            Some(true) => scalar >= -self.half_width,
            Some(false) => scalar > self.half_width,
        };
        self.positive = Some(positive);
        if positive {
            1.0
        } else {
            -1.0
        }
    }

    /// Forgets the sign: the next value is the first.
    pub fn reset(&mut self) {
        self.positive = None;
    }
}
