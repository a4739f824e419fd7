//! Control law (12) and the Lyapunov functions of its two layers.

use nalgebra::{Matrix3, Vector3};

use super::{Barrier, PerformanceFunction, VirtualLaw};
use crate::attitude::Quaternion;
use crate::error::{require_positive_definite, AllowedRange, ParameterError};

/// The term D_m tanh(z2 / p) of (12) against a bounded disturbance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisturbanceCompensation {
    /// D_m, bound of the norm of the disturbance torque, N m, not negative.
    pub bound_nm: f64,
    /// p, rad/s, positive: rate errors well above it meet the whole bound.
    pub smoothing_rad_s: f64,
}

/// Law (12): u = omega x J omega - K2 z2 + J alpha' - D_m tanh(z2 / p) - P_q with z2 = omega - alpha.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlLaw {
    /// J, kg m^2, symmetric positive definite.
    pub inertia: Matrix3<f64>,
    /// Funnel.
    pub performance: PerformanceFunction,
    /// First layer.
    pub barrier: Barrier,
    /// Virtual law.
    pub virtual_law: VirtualLaw,
    /// K2, N m s/rad, positive.
    pub rate_gain: f64,
    /// Disturbance term.
    pub disturbance: DisturbanceCompensation,
}

/// Everything that the law computes at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evaluation {
    /// rho of each axis, dimensionless.
    pub width: Vector3<f64>,
    /// Transformed error eps_i = q_i / rho_i, dimensionless.
    pub transformed: Vector3<f64>,
    /// Virtual rate alpha, rad/s.
    pub virtual_rate: Vector3<f64>,
    /// Rate error z2 = omega - alpha, rad/s.
    pub rate_error: Vector3<f64>,
    /// V1 of (13), J.
    pub barrier_value: f64,
    /// V2 = z2' J z2 / 2, J.
    pub rate_error_energy: f64,
    /// u of (12), N m, before saturation.
    pub torque: Vector3<f64>,
}

impl ControlLaw {
    /// Evaluates the law `elapsed_s` seconds after the start of the manoeuvre. The error quaternion has
    /// unit norm and a scalar part that is not negative (but for a hysteresis of its sign).
    pub fn evaluate(
        &self,
        elapsed_s: f64,
        error: &Quaternion,
        body_rate: &Vector3<f64>,
    ) -> Evaluation {
        let width = self.performance.value(elapsed_s);
        let width_rate = self.performance.rate(elapsed_s);
        let virtual_rate = self.virtual_law.rate(error, &width);
        let rate_error = body_rate - virtual_rate;
        let acceleration = self
            .virtual_law
            .acceleration(error, body_rate, &width, &width_rate);
        let smoothing = self.disturbance.smoothing_rad_s;
        let rejection = rate_error.map(|z2| libm::tanh(z2 / smoothing)) * self.disturbance.bound_nm;
        let torque = body_rate.cross(&(self.inertia * body_rate)) - rate_error * self.rate_gain
            + self.inertia * acceleration
            - rejection
            - self.barrier.compensation(error, &width);
        let transformed = error.vector.component_div(&width);
        Evaluation {
            width,
            transformed,
            virtual_rate,
            rate_error,
            barrier_value: self.barrier.value(&transformed),
            rate_error_energy: self.rate_error_energy(&rate_error),
            torque,
        }
    }

    /// V2 = z2' J z2 / 2 in J, of a rate error z2 in rad/s.
    pub fn rate_error_energy(&self, rate_error: &Vector3<f64>) -> f64 {
        0.5 * rate_error.dot(&(self.inertia * rate_error))
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        require_positive_definite("inertia", &self.inertia)?;
        self.performance.check()?;
        self.barrier.check()?;
        self.virtual_law.check()?;
        let positive = |name, value| AllowedRange::POSITIVE.check_scalar(name, value);
        positive("rate_gain", self.rate_gain)?;
        let bound = self.disturbance.bound_nm;
        AllowedRange::NON_NEGATIVE.check_scalar("disturbance_bound_nm", bound)?;
        positive("smoothing_rad_s", self.disturbance.smoothing_rad_s)
    }
}

impl Evaluation {
    /// False when anything overflowed.
    pub fn is_finite(&self) -> bool {
        let vectors = [&self.virtual_rate, &self.rate_error, &self.torque];
        let mut components = vectors.into_iter().flat_map(|vector| vector.iter());
        components.all(|value| value.is_finite())
            && self.barrier_value.is_finite()
            && self.rate_error_energy.is_finite()
    }
}
