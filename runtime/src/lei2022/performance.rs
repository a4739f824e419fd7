//! Performance function (3): how wide the funnel of each axis is.

use nalgebra::Vector3;

use crate::error::{AllowedRange, Field, ParameterError};

/// Performance function (3) of each axis. It falls from `initial` to `terminal` and is half way at
/// `midpoint_s`. Widths are those of components of the vector part of the error quaternion,
/// dimensionless; times count from the start of the manoeuvre, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PerformanceFunction {
    /// rho_0, above `terminal`.
    pub initial: Vector3<f64>,
    /// rho_infinity, positive.
    pub terminal: Vector3<f64>,
    /// T_s, s, not negative.
    pub midpoint_s: f64,
    /// f_s, s, positive: most of the fall is within twice this time of the midpoint.
    pub time_scale_s: f64,
}

impl PerformanceFunction {
    /// rho of each axis at a time.
    pub fn value(&self, elapsed_s: f64) -> Vector3<f64> {
        // At the midpoint 1/2; half of one minus the hyperbolic tangent of (3).
        let share = 0.5 * (1.0 - libm::tanh(self.phase(elapsed_s)));
        self.terminal + (self.initial - self.terminal) * share
    }

    /// Time derivative of rho of each axis, 1/s.
    pub fn rate(&self, elapsed_s: f64) -> Vector3<f64> {
        let slope = squared_hyperbolic_secant(self.phase(elapsed_s));
        (self.initial - self.terminal) * (-0.5 * slope / self.time_scale_s)
    }

    /// Largest component of the vector part over its width: below 1 inside of the funnel (4).
    pub fn occupancy(&self, elapsed_s: f64, vector: &Vector3<f64>) -> f64 {
        vector.component_div(&self.value(elapsed_s)).amax()
    }

    fn phase(&self, elapsed_s: f64) -> f64 {
        (elapsed_s - self.midpoint_s) / self.time_scale_s
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        for (axis, (&initial, &terminal)) in self.initial.iter().zip(&self.terminal).enumerate() {
            let field = |name| Field::component(name, axis);
            AllowedRange::POSITIVE.check(field("initial"), initial)?;
            AllowedRange::open(0.0, initial).check(field("terminal"), terminal)?;
        }
        AllowedRange::NON_NEGATIVE.check_scalar("midpoint_s", self.midpoint_s)?;
        AllowedRange::POSITIVE.check_scalar("time_scale_s", self.time_scale_s)
    }
}

/// 1 / cosh^2, accurate where it is small.
pub(super) fn squared_hyperbolic_secant(value: f64) -> f64 {
    let secant = 1.0 / libm::cosh(value);
    secant * secant
}
