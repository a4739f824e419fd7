//! How x'Ux of a design grows with the torque: what makes a network, a sensor or an actuator the worst possible one.

use std::fmt;

use nalgebra::SVector;

/// Takes the time (s) and the state.
type Gradient<'a, const N: usize, const M: usize> =
    dyn Fn(f64, &SVector<f64, N>) -> SVector<f64, M> + 'a;

/// B'Ux at a state: half of the derivative of (x'Ux)' by the torque.
pub struct InputGradient<'a, const N: usize, const M: usize>(Box<Gradient<'a, N, M>>);

impl<'a, const N: usize, const M: usize> InputGradient<'a, N, M> {
    /// The gradient that a function gives at a time (s) and a state.
    pub fn new(gradient: impl Fn(f64, &SVector<f64, N>) -> SVector<f64, M> + 'a) -> Self {
        Self(Box::new(gradient))
    }

    /// B'Ux at `time_s` seconds.
    pub fn at(&self, time_s: f64, state: &SVector<f64, N>) -> SVector<f64, M> {
        (self.0)(time_s, state)
    }
}

impl<const N: usize, const M: usize> fmt::Debug for InputGradient<'_, N, M> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("InputGradient")
    }
}
