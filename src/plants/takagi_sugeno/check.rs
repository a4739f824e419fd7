//! A Takagi-Sugeno model and its surroundings, checked.

use nalgebra::SVector;
use synth::fuzzy::VertexSystem;
use synth::model::{check_positive, finite, ModelError, Plant, PlantFile};

use super::file::{MixingFile, TakagiSugenoFile};
use super::Mixing;
use crate::base::plant_model::relocated;
use crate::base::ranges::{each, not_negative, require};
use crate::sim::disturbance::{Disturbance, Harmonic};
use crate::sim::embedding;

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
    /// Disturbance, padded.
    pub disturbance: Disturbance<MAX_STATES>,
    /// Standard deviation of the measurement of each state.
    pub state_noise: f64,
    /// Time from command to input, s.
    pub input_delay_s: f64,
}

pub(crate) fn takagi_sugeno(file: &TakagiSugenoFile) -> Result<TakagiSugenoSystem, ModelError> {
    let plant = Plant::new(&PlantFile::Vertices(file.vertices.clone()))
        .map_err(|error| relocated(error, "plant.vertices.", "vertices."))?;
    let Plant::Vertices(system) = plant else {
        return Err(length("vertices", 0, 1));
    };
    let (states, inputs) = system.input_matrix.shape();
    let sizes = [
        ("vertices.state_matrices", states, MAX_STATES),
        ("vertices.input_matrix", inputs, MAX_INPUTS),
        (
            "vertices.disturbance_matrix",
            system.disturbance_matrix.ncols(),
            MAX_STATES,
        ),
    ];
    for (field, size, largest) in sizes {
        let allowed = format!("at most {largest} columns; this is their number");
        require(size <= largest, field, size as f64, &allowed)?;
    }
    if file.initial_state.len() != states {
        return Err(length("initial_state", file.initial_state.len(), states));
    }
    each("initial_state", &file.initial_state, finite)?;
    not_negative("state_noise", file.state_noise)?;
    not_negative("input_delay_s", file.input_delay_s)?;
    Ok(TakagiSugenoSystem {
        mixing: mixing(&file.mixing, system.state_matrices.len())?,
        disturbance: signal(file, system.disturbance_matrix.ncols())?,
        initial_state: file.initial_state.clone(),
        state_noise: file.state_noise,
        input_delay_s: file.input_delay_s,
        system,
    })
}

pub(crate) fn length(field: &str, found: usize, expected: usize) -> ModelError {
    ModelError::WrongShape {
        field: field.to_string(),
        found: format!("{found} entries"),
        expected: format!("{expected} entries"),
    }
}

fn mixing(file: &MixingFile, vertices: usize) -> Result<Mixing, ModelError> {
    match file {
        MixingFile::Constant(weights) => {
            let field = "mixing.constant";
            if weights.len() != vertices {
                return Err(length(field, weights.len(), vertices));
            }
            each(field, weights, not_negative)?;
            let sum: f64 = weights.iter().sum();
            let ok = (sum - 1.0).abs() <= 1e-12;
            require(ok, field, sum, "weights with sum 1; this is their sum")?;
            Ok(Mixing::Constant(weights.clone()))
        }
        MixingFile::Model => Ok(Mixing::Model),
        MixingFile::Cycle(cycle) => {
            check_positive("mixing.cycle.dwell_s", cycle.dwell_s)?;
            Ok(Mixing::Cycle {
                dwell_s: cycle.dwell_s,
            })
        }
    }
}

fn signal(file: &TakagiSugenoFile, size: usize) -> Result<Disturbance<MAX_STATES>, ModelError> {
    let part = |field: &str, values: &[f64]| -> Result<SVector<f64, MAX_STATES>, ModelError> {
        if !values.is_empty() && values.len() != size {
            return Err(length(field, values.len(), size));
        }
        each(field, values, finite)?;
        Ok(embedding::vector(values))
    };
    let mut harmonics = Vec::new();
    for (index, sine) in file.disturbance.sines.iter().enumerate() {
        let field = format!("disturbance.sines[{index}]");
        check_positive(&format!("{field}.frequency_rad_s"), sine.frequency_rad_s)?;
        harmonics.push(Harmonic {
            frequency_rad_s: sine.frequency_rad_s,
            sine: part(&format!("{field}.sine"), &sine.sine)?,
            cosine: part(&format!("{field}.cosine"), &sine.cosine)?,
        });
    }
    Ok(Disturbance {
        bias: part("disturbance.bias", &file.disturbance.bias)?,
        harmonics,
        table: None,
        pulses: Vec::new(),
    })
}
