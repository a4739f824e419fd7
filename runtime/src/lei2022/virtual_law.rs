//! Virtual law (10): the rate at which the body should turn, and its time derivative.

use nalgebra::Vector3;

use super::performance::squared_hyperbolic_secant;
use crate::attitude::Quaternion;
use crate::error::{AllowedRange, ParameterError};

/// Virtual law (10) without an inverse: with r_i = rho_i tanh(gamma q_i / rho_i) and unit norm,
/// alpha = -k_m M sgn(q0) (q0^2 r - q0 q x r + q (q'r)).
///
/// Both methods take the error quaternion with unit norm and the sign already chosen: what they return
/// is that of (10) when its scalar part is not negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VirtualLaw {
    /// k_m, dimensionless, positive.
    pub gain: f64,
    /// M_omega, rad/s, positive.
    pub rate_scale_rad_s: f64,
    /// gamma, dimensionless, positive: how steep the hyperbolic tangent is.
    pub slope: f64,
}

impl VirtualLaw {
    /// alpha, rad/s, where the funnel's width rho is `width`.
    pub fn rate(&self, error: &Quaternion, width: &Vector3<f64>) -> Vector3<f64> {
        let (q0, q) = (error.scalar, &error.vector);
        let r = self.bounded(q, width);
        let direction = r * (q0 * q0) - q.cross(&r) * q0 + q * q.dot(&r);
        direction * -self.strength()
    }

    /// Time derivative of alpha, rad/s^2, at the body rate (rad/s), where the funnel's width is `width`
    /// and changes by `width_rate` (1/s).
    pub fn acceleration(
        &self,
        error: &Quaternion,
        body_rate: &Vector3<f64>,
        width: &Vector3<f64>,
        width_rate: &Vector3<f64>,
    ) -> Vector3<f64> {
        let (q0, q) = (error.scalar, &error.vector);
        let change = error.derivative(body_rate);
        let (dq0, dq) = (change.scalar, &change.vector);
        let r = self.bounded(q, width);
        let dr = self.bounded_rate(q, dq, width, width_rate);
        let direction = r * (2.0 * q0 * dq0) + dr * (q0 * q0)
            - q.cross(&r) * dq0
            - (dq.cross(&r) + q.cross(&dr)) * q0
            + dq * q.dot(&r)
            + q * (dq.dot(&r) + q.dot(&dr));
        direction * -self.strength()
    }

    /// k_m M_omega, rad/s.
    pub fn strength(&self) -> f64 {
        self.gain * self.rate_scale_rad_s
    }

    /// r, dimensionless.
    fn bounded(&self, q: &Vector3<f64>, width: &Vector3<f64>) -> Vector3<f64> {
        q.zip_map(width, |q, rho| rho * libm::tanh(self.slope * q / rho))
    }

    /// Time derivative of r, 1/s.
    fn bounded_rate(
        &self,
        q: &Vector3<f64>,
        dq: &Vector3<f64>,
        width: &Vector3<f64>,
        width_rate: &Vector3<f64>,
    ) -> Vector3<f64> {
        let phase = q.component_div(width) * self.slope;
        let growth = q.component_mul(width_rate).component_div(width);
        let moved = (dq - growth) * self.slope;
        let secant = phase.map(squared_hyperbolic_secant);
        width_rate.component_mul(&phase.map(libm::tanh)) + secant.component_mul(&moved)
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let positive = |name, value| AllowedRange::POSITIVE.check_scalar(name, value);
        positive("virtual_gain", self.gain)?;
        positive("rate_scale_rad_s", self.rate_scale_rad_s)?;
        positive("slope", self.slope)
    }
}
