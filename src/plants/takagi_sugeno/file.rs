//! A Takagi-Sugeno model and its surroundings, as written in a scenario file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use synth::model::VerticesPlant;

use crate::base::bounded::{As, NonNegative, Positive};

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
    /// Time from command to input, not negative (s).
    #[serde(default, with = "As::<NonNegative>")]
    pub input_delay_s: f64,
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
