//! Barrier Lyapunov function (5) of the transformed error, and its compensation in the law.

use core::f64::consts::LN_2;

use nalgebra::Vector3;

use crate::attitude::Quaternion;
use crate::error::{AllowedRange, ParameterError};

/// V1 = (k1 F1 / 2) ln cosh(eps'eps / F1), (5) and (13), of the error eps_i = q_i / rho_i.
///
/// Despite its name in the paper it is finite at |eps| = 1 and no barrier there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Barrier {
    /// k1, J, positive.
    pub gain_j: f64,
    /// F1, dimensionless, positive.
    pub width: f64,
}

impl Barrier {
    /// V1 in J at a transformed error (dimensionless).
    pub fn value(&self, transformed: &Vector3<f64>) -> f64 {
        let argument = transformed.dot(transformed) / self.width;
        // ln cosh x for x >= 0 without overflow; the series where the difference would cancel.
        let log_cosh = if argument < 1e-2 {
            let square = argument * argument;
            square * (0.5 - square * (1.0 / 12.0 - square / 45.0))
        } else {
            argument + libm::log1p(libm::exp(-2.0 * argument)) - LN_2
        };
        0.5 * self.gain_j * self.width * log_cosh
    }

    /// Gradient of V1 with respect to the transformed error, J: k1 tanh(eps'eps / F1) eps.
    pub fn gradient(&self, transformed: &Vector3<f64>) -> Vector3<f64> {
        let argument = transformed.dot(transformed) / self.width;
        transformed * (self.gain_j * libm::tanh(argument))
    }

    /// P_q, N m: the torque k1 tanh(eps'eps / F1) F_s' psi eps with which the rate error z2 enters the
    /// derivative of V1, at the error quaternion and the funnel's width rho of each axis.
    pub fn compensation(&self, error: &Quaternion, width: &Vector3<f64>) -> Vector3<f64> {
        let transformed = error.vector.component_div(width);
        let gradient = self.gradient(&transformed).component_div(width);
        // F_s' v = (q0 v - q x v) / 2.
        (gradient * error.scalar - error.vector.cross(&gradient)) * 0.5
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let positive = |name, value| AllowedRange::POSITIVE.check_scalar(name, value);
        positive("barrier_gain_j", self.gain_j)?;
        positive("barrier_width", self.width)
    }
}
