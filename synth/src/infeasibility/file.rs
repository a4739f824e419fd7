//! The infeasibility certificate, as written, and its check.

use nalgebra::DMatrix;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::certify::infeasible::{refute, DualMultipliers, Refutation};
use crate::design::Provenance;
use crate::model::{check_matrix, parse, FileError, Kind, Model, ModelError, ModelFile};

/// The version this program reads and writes.
pub const INFEASIBILITY_SCHEMA_VERSION: u32 = 1;

/// A proof that no design exists for a model. SI units throughout; n states, m inputs, d
/// disturbances, v = eps1 x + eps2 x' + eps3 x(t_k^l).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InfeasibilityFile {
    /// Version of this format: 1.
    pub schema_version: u32,
    /// Name of the model.
    pub name: String,
    /// The model, whole.
    pub model: ModelFile,
    /// The given gains F_j, each m x n, for which no proof exists; left out, no constant gain has a design.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gains: Vec<Vec<Vec<f64>>>,
    /// The weights; one set for each weight rho of the containment condition, a single one when the
    /// model has no states that must be contained.
    pub infeasibility: Vec<WeightsFile>,
    /// What made the file.
    pub provenance: Provenance,
}

/// Weights of the conditions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WeightsFile {
    /// The weight rho of the containment condition, above 0. Left out when the model has no states
    /// that must be contained.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub containment_weight: Option<f64>,
    /// Number of the given gain, from 1, that the next four keys are about; left out without given gains.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain: Option<usize>,
    /// Weights of (18), r = 1.
    pub decrease_start: MomentsFile,
    /// Weights of (18), r = 2.
    pub decrease_end: MomentsFile,
    /// E[s s'] of r = 2, with the integral's coordinate s: n x n, symmetric.
    pub integral: Vec<Vec<f64>>,
    /// Weights of (19), one for each input.
    pub anti_windup: Vec<InputWeightFile>,
    /// Weights of further given gains. Gains that do not occur have weight 0.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub further_gains: Vec<GainWeightsFile>,
    /// Weights of the region's conditions, in their order.
    pub region: Vec<RegionWeightFile>,
    /// Weights of the containment conditions, one for each state: n x n, symmetric.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub must_contain: Vec<Vec<Vec<f64>>>,
}

/// Weights of the conditions of a given gain beyond the first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GainWeightsFile {
    /// Number of the gain, from 1.
    pub gain: usize,
    /// Weights of (18), r = 1.
    pub decrease_start: MomentsFile,
    /// Weights of (18), r = 2.
    pub decrease_end: MomentsFile,
    /// E[s s'] of r = 2: n x n, symmetric.
    pub integral: Vec<Vec<f64>>,
    /// E[x s'] of r = 2, n x n.
    pub state_integral: Vec<Vec<f64>>,
    /// E[x(t_k^l) s'] of r = 2, n x n.
    pub sample_integral: Vec<Vec<f64>>,
    /// Weights of (19), one for each input.
    pub anti_windup: Vec<InputWeightFile>,
}

/// Weights of (18) at one end of the sampling interval, as second moments of its coordinates.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MomentsFile {
    /// Weights of the vertices that matter; the others' are zero.
    pub vertices: Vec<VertexWeightFile>,
    /// E[x x(t_k^l)'], n x n.
    pub state_sample: Vec<Vec<f64>>,
    /// E[v x(t_k^l)'], n x n. May be left out for r = 2: it is then what makes the sum independent of
    /// the multiplier, and the proof needs no bound.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub multiplied_sample: Option<Vec<Vec<f64>>>,
    /// E[x(t_k^l) x(t_k^l)'], n x n, symmetric.
    pub sample: Vec<Vec<f64>>,
    /// E[v tau'], n x d.
    pub multiplied_disturbance: Vec<Vec<f64>>,
    /// E[tau tau'], d x d, symmetric.
    pub disturbance: Vec<Vec<f64>>,
    /// Moments with the held state w = x(t_k); left out, w = x(t_k^l).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub held: Option<HeldMomentsFile>,
    /// Moments with the dead zone p; exactly for given gains.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dead_zone: Option<DeadZoneMomentsFile>,
}

/// Moments with the dead zone p. m inputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeadZoneMomentsFile {
    /// E[v p'], n x m.
    pub multiplied_zone: Vec<Vec<f64>>,
    /// E[w p'], n x m.
    pub held_zone: Vec<Vec<f64>>,
    /// E[p p'], m x m, symmetric.
    pub zone: Vec<Vec<f64>>,
}

/// Weight of (18) at one vertex.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VertexWeightFile {
    /// Number of the vertex, from 1.
    pub vertex: usize,
    /// Second moments of (x, v), 2n x 2n, symmetric.
    pub moments: Vec<Vec<f64>>,
}

/// Moments with the held state w.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeldMomentsFile {
    /// E[v w'], n x n.
    pub multiplied_held: Vec<Vec<f64>>,
    /// E[x(t_k^l) w'], n x n.
    pub sample_held: Vec<Vec<f64>>,
    /// E[w w'], n x n, symmetric.
    pub held: Vec<Vec<f64>>,
}

/// Weight of one condition (19).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InputWeightFile {
    /// The block of the state, n x n, symmetric.
    pub state: Vec<Vec<f64>>,
    /// The corner.
    pub unit: f64,
}

/// Weight of one condition of the region with k rows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionWeightFile {
    /// The block of the state, n x n, symmetric.
    pub state: Vec<Vec<f64>>,
    /// The block beside the corner, n x k.
    pub cross: Vec<Vec<f64>>,
    /// The corner, k x k, symmetric.
    pub unit: Vec<Vec<f64>>,
}

impl InfeasibilityFile {
    /// Puts a file together.
    pub(crate) fn new(
        model: &Model,
        given: &[DMatrix<f64>],
        infeasibility: Vec<WeightsFile>,
        provenance: Provenance,
    ) -> Self {
        InfeasibilityFile {
            schema_version: INFEASIBILITY_SCHEMA_VERSION,
            name: model.file.name.clone(),
            model: model.file.clone(),
            gains: given.iter().map(rows).collect(),
            infeasibility,
            provenance,
        }
    }

    /// Reads the text of an infeasibility certificate; shapes and ranges are checked, nothing is
    /// proved.
    pub fn from_json(text: &str) -> Result<(Self, Model), FileError> {
        let file: InfeasibilityFile = parse(text, Kind::Infeasibility)?;
        if file.schema_version != INFEASIBILITY_SCHEMA_VERSION {
            return Err(ModelError::SchemaVersion {
                found: file.schema_version,
                expected: INFEASIBILITY_SCHEMA_VERSION,
            }
            .into());
        }
        let model = Model::new(file.model.clone()).map_err(|error| error.within("model"))?;
        file.weights(&model)?;
        Ok((file, model))
    }

    /// The given gains whose conditions have weights, numbered from 1: together they cannot hold. Empty
    /// where no gains are given.
    pub fn blocking_gains(&self) -> Vec<usize> {
        let sets = self.infeasibility.iter();
        let gains = sets.flat_map(|set| {
            let further = set.further_gains.iter().map(|weights| weights.gain);
            set.gain.into_iter().chain(further)
        });
        let mut gains: Vec<usize> = gains.collect();
        gains.sort_unstable();
        gains.dedup();
        gains
    }

    /// The file's text: JSON whose numbers read back exactly.
    pub fn to_json(&self) -> String {
        // The file holds finite numbers and string keys only, so it can always be written.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// The numbers, every set of weights.
    pub fn weights(&self, model: &Model) -> Result<Vec<DualMultipliers>, ModelError> {
        if self.infeasibility.is_empty() {
            return Err(ModelError::WrongShape {
                field: "infeasibility".to_string(),
                found: "0 sets of weights".to_string(),
                expected: "at least 1".to_string(),
            });
        }
        let (n, m, _, _) = model.plant.sizes();
        let given = self.gains.iter().enumerate().map(|(index, gain)| {
            check_matrix(&format!("gains[{index}]"), gain, (Some(m), Some(n)))
        });
        let given = given.collect::<Result<Vec<_>, _>>()?;
        let sets = self.infeasibility.iter().enumerate();
        sets.map(|(index, set)| {
            let weights = set.weights(model, &given);
            weights.map_err(|error| error.within(&format!("infeasibility[{index}]")))
        })
        .collect()
    }

    /// Proves from the file's numbers alone that no design exists, or says what is not proved: one
    /// outcome for each set of weights.
    pub fn verify(&self, model: &Model) -> Result<Vec<Refutation>, ModelError> {
        let sets = self.weights(model)?;
        Ok(sets.iter().map(|weights| refute(model, weights)).collect())
    }
}

/// Files hold no numbers below 1e-30 but 0.
const SMALLEST: f64 = 1e-30;

pub(super) fn flushed(value: f64) -> f64 {
    match value.abs() < SMALLEST {
        true => 0.0,
        false => value,
    }
}

pub(super) fn rows(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let row = |r: usize| matrix.row(r).iter().copied().map(flushed).collect();
    (0..matrix.nrows()).map(row).collect()
}
