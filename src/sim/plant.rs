//! Plants: what a controller is tried on.

use nalgebra::SVector;
use synth::model::ModelError;

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

/// A plant as written in a scenario file.
pub trait PlantFile {
    /// The plant with its surroundings, with its numbers checked.
    type System;

    /// The quantities of a profile of its runs, with units.
    const QUANTITIES: &'static [&'static str];

    /// Checks the numbers. `seed`: that of the scenario, for what is sampled.
    ///
    /// # Errors
    /// A number that is out of its range; the field is named from the plant's own object on.
    fn check(&self, seed: u64) -> Result<Self::System, ModelError>;
}
