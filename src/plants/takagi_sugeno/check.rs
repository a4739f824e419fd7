//! A Takagi-Sugeno model and its surroundings, checked.

use synth::fuzzy::VertexSystem;
use synth::model::{finite, vertex_system, ModelError};

use super::file::{Mixing, SignalFile, TakagiSugenoFile};
use crate::base::plant_model::relocated;
use crate::base::ranges::{each, not_negative, require};
use crate::sim::disturbance::{Disturbance, Harmonic};
use crate::sim::embedding;
use crate::sim::plant::PlantFile;

/// Largest Takagi-Sugeno plant: states (and disturbances).
pub const MAX_STATES: usize = 24;
/// Largest Takagi-Sugeno plant: inputs.
pub const MAX_INPUTS: usize = 12;

/// A Takagi-Sugeno model and its surroundings.
#[derive(Debug, Clone)]
pub struct TakagiSugenoSystem {
    /// The vertex systems.
    pub system: VertexSystem,
    /// Their weights in time.
    pub mixing: Mixing,
    /// State at the start.
    pub initial_state: Vec<f64>,
    /// Disturbance.
    pub disturbance: SignalFile,
    /// Standard deviation of the measurement of each state.
    pub state_noise: f64,
    /// Time from command to input, s.
    pub input_delay_s: f64,
}

impl PlantFile for TakagiSugenoFile {
    type System = TakagiSugenoSystem;

    const QUANTITIES: &'static [&'static str] = &["state_norm"];

    fn check(&self, _seed: u64) -> Result<TakagiSugenoSystem, ModelError> {
        let system = vertex_system(&self.vertices)
            .map_err(|error| relocated(error, "plant.vertices.", "vertices."))?;
        let (states, inputs) = system.input_matrix.shape();
        let disturbances = system.disturbance_matrix.ncols();
        for (field, size, largest) in [
            ("vertices.state_matrices", states, MAX_STATES),
            ("vertices.input_matrix", inputs, MAX_INPUTS),
            ("vertices.disturbance_matrix", disturbances, MAX_STATES),
        ] {
            let allowed = format!("at most {largest} columns; this is their number");
            require(size <= largest, field, size as f64, &allowed)?;
        }
        check_length("initial_state", &self.initial_state, states)?;
        each("initial_state", &self.initial_state, finite)?;
        self.disturbance.check(disturbances)?;
        if let Mixing::Constant(weights) = &self.mixing {
            let field = "mixing.constant";
            check_length(field, weights, system.state_matrices.len())?;
            each(field, weights, not_negative)?;
            let sum: f64 = weights.iter().sum();
            let ok = (sum - 1.0).abs() <= 1e-12;
            require(ok, field, sum, "weights with sum 1; this is their sum")?;
        }
        Ok(TakagiSugenoSystem {
            mixing: self.mixing.clone(),
            disturbance: self.disturbance.clone(),
            initial_state: self.initial_state.clone(),
            state_noise: self.state_noise,
            input_delay_s: self.input_delay_s,
            system,
        })
    }
}

fn check_length(field: &str, values: &[f64], expected: usize) -> Result<(), ModelError> {
    if values.len() == expected {
        return Ok(());
    }
    Err(ModelError::shape(
        field,
        format!("{} entries", values.len()),
        format!("{expected} entries"),
    ))
}

impl SignalFile {
    /// Every part must have `size` components or none.
    fn check(&self, size: usize) -> Result<(), ModelError> {
        let part = |field: &str, values: &[f64]| {
            if !values.is_empty() {
                check_length(field, values, size)?;
            }
            each(field, values, finite)
        };
        for (index, sine) in self.sines.iter().enumerate() {
            let field = format!("disturbance.sines[{index}]");
            part(&format!("{field}.sine"), &sine.sine)?;
            part(&format!("{field}.cosine"), &sine.cosine)?;
        }
        part("disturbance.bias", &self.bias)
    }

    /// The signal padded with zeros to `D` components.
    pub fn padded<const D: usize>(&self) -> Disturbance<D> {
        let harmonics = self.sines.iter().map(|sine| Harmonic {
            frequency_rad_s: sine.frequency_rad_s,
            sine: embedding::vector(&sine.sine),
            cosine: embedding::vector(&sine.cosine),
        });
        Disturbance {
            bias: embedding::vector(&self.bias),
            harmonics: harmonics.collect(),
            ..Disturbance::none()
        }
    }
}
