//! Plants: what a controller is tried on.

use nalgebra::SVector;

/// A plant of `N` states, `M` inputs and `D` disturbances.
pub trait Plant<const N: usize, const M: usize, const D: usize> {
    /// Time derivative of the state at `time_s` seconds.
    fn derivative(
        &self,
        time_s: f64,
        state: &SVector<f64, N>,
        input: &SVector<f64, M>,
        disturbance: &SVector<f64, D>,
    ) -> SVector<f64, N>;

    /// Puts a state back on the plant's state space after an integration step.
    fn project(&self, state: &mut SVector<f64, N>);
}
