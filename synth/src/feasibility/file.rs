//! The infeasibility certificate, as written, and its check.

use nalgebra::DMatrix;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::certify::infeasible::{
    refute, HeldMoments, InputWeight, Moments, Refutation, RegionWeight, VertexWeight, Weights,
};
use crate::design::Provenance;
use crate::model::{
    check_matrix, check_positive, check_symmetric, finite, parse, FileError, Kind, Model,
    ModelError, ModelFile,
};

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
    /// Weights of (18), r = 1.
    pub decrease_start: MomentsFile,
    /// Weights of (18), r = 2.
    pub decrease_end: MomentsFile,
    /// E[s s'] of r = 2, with the integral's coordinate s: n x n, symmetric.
    pub integral: Vec<Vec<f64>>,
    /// Weights of (19), one for each input.
    pub anti_windup: Vec<InputWeightFile>,
    /// Weights of the region's conditions, in their order.
    pub region: Vec<RegionWeightFile>,
    /// Weights of the containment conditions, one for each state: n x n, symmetric.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub must_contain: Vec<Vec<Vec<f64>>>,
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
    pub(super) fn new(
        model: &Model,
        infeasibility: Vec<WeightsFile>,
        provenance: Provenance,
    ) -> Self {
        InfeasibilityFile {
            schema_version: INFEASIBILITY_SCHEMA_VERSION,
            name: model.file.name.clone(),
            model: model.file.clone(),
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

    /// The file's text: JSON whose numbers read back exactly.
    pub fn to_json(&self) -> String {
        // The file holds finite numbers and string keys only, so it can always be written.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    /// The numbers, every set of weights.
    pub fn weights(&self, model: &Model) -> Result<Vec<Weights>, ModelError> {
        if self.infeasibility.is_empty() {
            return Err(ModelError::WrongShape {
                field: "infeasibility".to_string(),
                found: "0 sets of weights".to_string(),
                expected: "at least 1".to_string(),
            });
        }
        let sets = self.infeasibility.iter().enumerate();
        sets.map(|(index, set)| {
            let weights = set.weights(model);
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

impl WeightsFile {
    /// The numbers as written. Those too small to be allowed in a file become 0.
    pub(super) fn new(weights: &Weights, model: &Model) -> Self {
        let input = |weight: &InputWeight| InputWeightFile {
            state: rows(&weight.state),
            unit: flushed(weight.unit),
        };
        let region = |weight: &RegionWeight| RegionWeightFile {
            state: rows(&weight.state),
            cross: rows(&weight.cross),
            unit: rows(&weight.unit),
        };
        let contains = !model.file.specs.must_contain.is_empty();
        WeightsFile {
            containment_weight: contains.then_some(weights.containment_weight),
            decrease_start: MomentsFile::new(&weights.start),
            decrease_end: MomentsFile::new(&weights.end),
            integral: rows(&weights.integral),
            anti_windup: weights.inputs.iter().map(input).collect(),
            region: weights.region.iter().map(region).collect(),
            must_contain: weights.must_contain.iter().map(rows).collect(),
        }
    }

    /// Checked numbers.
    pub(super) fn weights(&self, model: &Model) -> Result<Weights, ModelError> {
        let system = model.plant.nominal().takagi_sugeno();
        let (n, m) = (system.states(), system.inputs());
        check_length("anti_windup", self.anti_windup.len(), m)?;
        check_length("region", self.region.len(), system.region.len())?;
        let contained = model.file.specs.must_contain.len();
        check_length("must_contain", self.must_contain.len(), contained)?;
        let inputs = self.anti_windup.iter().enumerate().map(|(index, weight)| {
            let field = format!("anti_windup[{index}]");
            finite(&format!("{field}.unit"), weight.unit)?;
            Ok(InputWeight {
                state: symmetric(&format!("{field}.state"), &weight.state, n)?,
                unit: weight.unit,
            })
        });
        let bounds = self.region.iter().zip(&system.region).enumerate();
        let region = bounds.map(|(index, (weight, bound))| {
            let field = format!("region[{index}]");
            let k = bound.rows.nrows();
            let cross = (Some(n), Some(k));
            Ok(RegionWeight {
                state: symmetric(&format!("{field}.state"), &weight.state, n)?,
                cross: check_matrix(&format!("{field}.cross"), &weight.cross, cross)?,
                unit: symmetric(&format!("{field}.unit"), &weight.unit, k)?,
            })
        });
        let must_contain = self.must_contain.iter().enumerate();
        let must_contain =
            must_contain.map(|(index, rows)| symmetric(&format!("must_contain[{index}]"), rows, n));
        let start = self.decrease_start.moments(model);
        let start = start.map_err(|error| error.within("decrease_start"))?;
        if start.multiplied_sample.is_none() {
            return Err(ModelError::WrongShape {
                field: "decrease_start.multiplied_sample".to_string(),
                found: "nothing".to_string(),
                expected: format!("{n} x {n}"),
            });
        }
        let end = self.decrease_end.moments(model);
        let end = end.map_err(|error| error.within("decrease_end"))?;
        if end.multiplied_sample.is_none() && model.file.specs.eps[2] == 0.0 {
            return Err(ModelError::WrongShape {
                field: "decrease_end.multiplied_sample".to_string(),
                found: "nothing".to_string(),
                expected: format!("{n} x {n}, because eps[2] is 0"),
            });
        }
        Ok(Weights {
            containment_weight: self.containment(contained > 0)?,
            start,
            end,
            integral: symmetric("integral", &self.integral, n)?,
            inputs: inputs.collect::<Result<_, _>>()?,
            region: region.collect::<Result<_, _>>()?,
            must_contain: must_contain.collect::<Result<_, _>>()?,
        })
    }

    fn containment(&self, needed: bool) -> Result<f64, ModelError> {
        match (needed, self.containment_weight) {
            (true, Some(weight)) => {
                check_positive("containment_weight", weight)?;
                Ok(weight)
            }
            (true, None) => Err(ModelError::WrongShape {
                field: "containment_weight".to_string(),
                found: "nothing".to_string(),
                expected: "a number above 0, because the model has must_contain states".to_string(),
            }),
            (false, Some(value)) => Err(ModelError::OutOfRange {
                field: "containment_weight".to_string(),
                value,
                allowed: "left out: the model has no must_contain states".to_string(),
            }),
            (false, None) => Ok(1.0),
        }
    }
}

impl MomentsFile {
    fn new(moments: &Moments) -> Self {
        let vertex = |weight: &VertexWeight| VertexWeightFile {
            vertex: weight.vertex + 1,
            moments: rows(&weight.moments),
        };
        let held = |held: &HeldMoments| HeldMomentsFile {
            multiplied_held: rows(&held.multiplied_held),
            sample_held: rows(&held.sample_held),
            held: rows(&held.held),
        };
        MomentsFile {
            vertices: moments.vertices.iter().map(vertex).collect(),
            state_sample: rows(&moments.state_sample),
            multiplied_sample: moments.multiplied_sample.as_ref().map(rows),
            sample: rows(&moments.sample),
            multiplied_disturbance: rows(&moments.multiplied_disturbance),
            disturbance: rows(&moments.disturbance),
            held: moments.held.as_ref().map(held),
        }
    }

    fn moments(&self, model: &Model) -> Result<Moments, ModelError> {
        let (n, _, d, _) = model.plant.sizes();
        let count = model.plant.nominal().takagi_sugeno().vertices.len();
        let square = (Some(n), Some(n));
        let vertices = self.vertices.iter().enumerate().map(|(index, weight)| {
            let field = format!("vertices[{index}]");
            if !(1..=count).contains(&weight.vertex) {
                return Err(ModelError::OutOfRange {
                    field: format!("{field}.vertex"),
                    value: weight.vertex as f64,
                    allowed: format!("1 to {count}"),
                });
            }
            Ok(VertexWeight {
                vertex: weight.vertex - 1,
                moments: symmetric(&format!("{field}.moments"), &weight.moments, 2 * n)?,
            })
        });
        let multiplied_sample = self.multiplied_sample.as_ref();
        let multiplied_sample =
            multiplied_sample.map(|rows| check_matrix("multiplied_sample", rows, square));
        let held = self.held.as_ref().map(|held| {
            Ok(HeldMoments {
                multiplied_held: check_matrix(
                    "held.multiplied_held",
                    &held.multiplied_held,
                    square,
                )?,
                sample_held: check_matrix("held.sample_held", &held.sample_held, square)?,
                held: symmetric("held.held", &held.held, n)?,
            })
        });
        Ok(Moments {
            vertices: vertices.collect::<Result<_, _>>()?,
            state_sample: check_matrix("state_sample", &self.state_sample, square)?,
            multiplied_sample: multiplied_sample.transpose()?,
            sample: symmetric("sample", &self.sample, n)?,
            multiplied_disturbance: check_matrix(
                "multiplied_disturbance",
                &self.multiplied_disturbance,
                (Some(n), Some(d)),
            )?,
            disturbance: symmetric("disturbance", &self.disturbance, d)?,
            held: held.transpose()?,
        })
    }
}

fn check_length(field: &str, found: usize, expected: usize) -> Result<(), ModelError> {
    if found == expected {
        return Ok(());
    }
    Err(ModelError::WrongShape {
        field: field.to_string(),
        found: format!("{found} entries"),
        expected: format!("{expected} entries"),
    })
}

fn symmetric(field: &str, rows: &[Vec<f64>], side: usize) -> Result<DMatrix<f64>, ModelError> {
    let matrix = check_matrix(field, rows, (Some(side), Some(side)))?;
    check_symmetric(field, &matrix)?;
    Ok(matrix)
}

/// Files hold no numbers below 1e-30 but 0.
const SMALLEST: f64 = 1e-30;

fn flushed(value: f64) -> f64 {
    match value.abs() < SMALLEST {
        true => 0.0,
        false => value,
    }
}

fn rows(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let row = |r: usize| matrix.row(r).iter().copied().map(flushed).collect();
    (0..matrix.nrows()).map(row).collect()
}
