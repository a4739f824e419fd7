//! A Takagi-Sugeno model and its surroundings in the scenario file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::fuzzy::VertexSystem;
use synth::model::{check_not_negative, finite, vertex_system, ModelError, VerticesPlant};

use crate::base::bounded::{As, NonNegative, Positive};
use crate::base::plant_model::relocated;
use crate::base::ranges::{each, require};
use crate::sim::disturbance::{Disturbance, Harmonic};
use crate::sim::embedding;
use crate::sim::gain_error::{GainError, GainErrorFile};
use crate::sim::measurement_error::{check_direction, ErrorBounds, ErrorGroup, ErrorKind};
use crate::sim::plant::PlantFile;

/// A Takagi-Sugeno model as the plant: x' = A(t) x + B u + B_w tau.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TakagiSugenoFile {
    /// Its vertex systems, as in a model file. At most 24 states and 12 inputs.
    pub vertices: VerticesPlant,
    /// How they are weighted in time.
    pub mixing: Mixing,
    /// State at the start, n entries.
    pub initial_state: Vec<f64>,
    /// Disturbance; none when left out.
    #[serde(default)]
    pub disturbance: SignalFile,
    /// Standard deviation of the measurement of each state, not negative.
    #[serde(default, with = "As::<NonNegative>")]
    pub state_noise: f64,
    /// Errors of the measurement within bounds, beside the noise; none when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measurement_error: Option<StateErrorFile>,
    /// Time from command to input, not negative (s).
    #[serde(default, with = "As::<NonNegative>")]
    pub input_delay_s: f64,
    /// Uncertain gains of the inputs; none when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain_error: Option<GainErrorFile>,
}

/// Errors of the measurement within bounds, as a model's `imperfections.measurement` states them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StateErrorFile {
    /// Bound on the error of each state, n entries, not negative.
    #[serde(with = "As::<Vec<NonNegative>>")]
    pub state: Vec<f64>,
    /// How the errors are chosen.
    pub kind: ErrorKind,
}

impl StateErrorFile {
    fn check(&self, states: usize) -> Result<ErrorBounds, ModelError> {
        check_length("measurement_error.state", &self.state, states)?;
        check_direction("measurement_error", &self.kind, states)?;
        let each = self.state.iter().enumerate();
        let groups = each.map(|(state, &bound)| ErrorGroup {
            states: state..state + 1,
            bound,
            scale: 1.0,
        });
        Ok(ErrorBounds {
            groups: groups.collect(),
            kind: self.kind.clone(),
        })
    }
}

/// How the vertex systems are weighted in time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Mixing {
    /// Constant weights, one for each vertex, not negative, with sum 1.
    Constant(Vec<f64>),
    /// From each vertex to the next and from the last back to the first, linearly.
    Cycle {
        /// Time from one vertex to the next, above 0 (s).
        #[serde(with = "As::<Positive>")]
        dwell_s: f64,
    },
    /// By the memberships of the design's model at the plant's state; the vertices are its rules.
    Model,
}

/// A disturbance of any size: the sum of its parts.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SignalFile {
    /// Constant part; zero when left out.
    #[serde(default)]
    pub bias: Vec<f64>,
    /// Periodic parts.
    #[serde(default)]
    pub sines: Vec<SignalSineFile>,
    /// Norm of a part along B_w'Ux of the design, where x'Ux grows fastest, chosen anew at every sample and every arrival;
    /// not negative.
    #[serde(default, with = "As::<NonNegative>")]
    pub worst: f64,
}

/// `sine sin(frequency t) + cosine cos(frequency t)`; a part left out is zero.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SignalSineFile {
    /// Angular frequency, above 0 [rad/s].
    #[serde(with = "As::<Positive>")]
    pub frequency_rad_s: f64,
    /// Amplitude of the sine.
    #[serde(default)]
    pub sine: Vec<f64>,
    /// Amplitude of the cosine.
    #[serde(default)]
    pub cosine: Vec<f64>,
}

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
    /// Bounded errors of the measurement.
    pub measurement_error: Option<ErrorBounds>,
    /// Time from command to input, s.
    pub input_delay_s: f64,
    /// Uncertain gains of the inputs.
    pub gain_error: Option<GainError<MAX_INPUTS>>,
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
            each(field, weights, check_not_negative)?;
            let sum: f64 = weights.iter().sum();
            let ok = (sum - 1.0).abs() <= 1e-12;
            require(ok, field, sum, "weights with sum 1; this is their sum")?;
        }
        let error = self.measurement_error.as_ref();
        let gain = self.gain_error.as_ref();
        let gain_error = gain.map(|gain| gain.data(inputs)).transpose();
        Ok(TakagiSugenoSystem {
            measurement_error: error.map(|error| error.check(states)).transpose()?,
            gain_error: gain_error.map_err(|error| error.within("gain_error"))?,
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
            worst: self.worst,
            ..Disturbance::none()
        }
    }
}
