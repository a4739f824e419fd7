//! What a search did, for a design's provenance.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a search chose the numbers of the design's model. The proof is about the model as it stands in the
/// design and does not need this.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SearchRecord {
    /// What was sought: region or gain.
    pub objective: String,
    /// Semidefinite programs solved on the way.
    pub evaluations: u32,
    /// What was varied, and the values chosen.
    pub varied: Vec<VariedFile>,
    /// P of the last containment condition Qh'P + P'Qh - P'Uh P >= s^2 D D', n x n.
    pub linearisation: Vec<Vec<f64>>,
}

/// A number that a search chose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VariedFile {
    /// Its field in the model.
    pub field: String,
    /// The lowest value allowed.
    pub lowest: f64,
    /// The highest value allowed.
    pub highest: f64,
    /// The value chosen.
    pub value: f64,
}
