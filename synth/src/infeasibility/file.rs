//! The infeasibility certificate, as written, and its check.

use nalgebra::DMatrix;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::certify::infeasible::{
    refute, DualMultipliers, GainDuals, InputDual, IntegralCross, Moments, Refutation, RegionDual,
};
use crate::design::{rows, Provenance};
use crate::model::bounded::{As, FromOne, Positive, Rows};
use crate::model::{
    check_matrix, check_symmetric, parse, FileError, Kind, Model, ModelError, ModelFile,
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
    /// The given gains F_j, each m x n, for which no proof exists; left out, no constant gain has a design.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gains: Vec<Vec<Vec<f64>>>,
    /// The dual multipliers; one set for each weight rho of the containment condition, a single one when the
    /// model has no states that must be contained.
    pub infeasibility: Vec<WeightsFile>,
    /// What made the file.
    pub provenance: Provenance,
}

/// Dual multipliers of the conditions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WeightsFile {
    /// The weight rho of the containment condition. Left out when the model has no states that must be contained.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<Positive>>")]
    pub containment_weight: Option<f64>,
    /// The given gain, numbered from 1, that the next four keys are about; left out without given gains.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<FromOne>>")]
    pub gain: Option<usize>,
    /// Dual multipliers of (18), r = 1.
    pub decrease_start: Moments,
    /// Dual multipliers of (18), r = 2.
    pub decrease_end: Moments,
    /// E[s s'] of r = 2, with the integral's coordinate s: n x n, symmetric.
    #[serde(with = "As::<Rows>")]
    pub integral: DMatrix<f64>,
    /// Dual multipliers of (19), one for each input.
    pub anti_windup: Vec<InputDual>,
    /// Dual multipliers of further given gains; those of gains that do not occur are 0.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub further_gains: Vec<GainWeightsFile>,
    /// Dual multipliers of the region's conditions, in their order.
    pub region: Vec<RegionDual>,
    /// Dual multipliers of the containment conditions, one for each state: n x n, symmetric.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[serde(with = "As::<Vec<Rows>>")]
    pub must_contain: Vec<DMatrix<f64>>,
}

/// Dual multipliers of the conditions of a given gain beyond the first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GainWeightsFile {
    /// The gain, numbered from 1.
    #[serde(with = "As::<FromOne>")]
    pub gain: usize,
    /// Dual multipliers of (18), r = 1.
    pub decrease_start: Moments,
    /// Dual multipliers of (18), r = 2.
    pub decrease_end: Moments,
    /// E[s s'] of r = 2: n x n, symmetric.
    #[serde(with = "As::<Rows>")]
    pub integral: DMatrix<f64>,
    /// E[x s'] of r = 2, n x n.
    #[serde(with = "As::<Rows>")]
    pub state_integral: DMatrix<f64>,
    /// E[x(t_k^l) s'] of r = 2, n x n.
    #[serde(with = "As::<Rows>")]
    pub sample_integral: DMatrix<f64>,
    /// Dual multipliers of (19), one for each input.
    pub anti_windup: Vec<InputDual>,
}

/// Sizes of a model, and how many gains are given.
#[derive(Clone, Copy)]
struct Sizes {
    states: usize,
    inputs: usize,
    disturbances: usize,
    vertices: usize,
    given: usize,
}

impl WeightsFile {
    /// The numbers as a reader of the file gets them, `None` without dual multipliers of a gain or where no file may
    /// hold them.
    pub(crate) fn new(duals: DualMultipliers) -> Option<Self> {
        let contains = !duals.must_contain.is_empty();
        let given = !duals.given.is_empty();
        let mut gains = duals.gains.into_iter();
        let first = gains.next()?;
        let further = gains.filter_map(|of| {
            let cross = of.integral_cross?;
            Some(GainWeightsFile {
                gain: of.gain,
                decrease_start: of.start,
                decrease_end: of.end,
                integral: of.integral,
                state_integral: cross.state,
                sample_integral: cross.sample,
                anti_windup: of.inputs,
            })
        });
        let written = WeightsFile {
            containment_weight: contains.then_some(duals.containment_weight),
            gain: given.then_some(first.gain),
            decrease_start: first.start,
            decrease_end: first.end,
            integral: first.integral,
            anti_windup: first.inputs,
            further_gains: further.collect(),
            region: duals.region,
            must_contain: duals.must_contain,
        };
        serde_json::from_value(serde_json::to_value(written).ok()?).ok()
    }

    /// The numbers, with the checks of their shapes.
    pub(crate) fn weights(
        &self,
        model: &Model,
        given: &[DMatrix<f64>],
    ) -> Result<DualMultipliers, ModelError> {
        let system = model.plant.nominal().takagi_sugeno();
        let sizes = Sizes {
            states: system.states(),
            inputs: system.inputs(),
            disturbances: system.disturbance.ncols(),
            vertices: system.vertices.len(),
            given: given.len(),
        };
        let n = sizes.states;
        check_length("region", self.region.len(), system.region.len())?;
        // Without them the statement is about every rho.
        let contained = match self.must_contain.is_empty() && self.containment_weight.is_none() {
            true => 0,
            false => model.file.specs.must_contain.len(),
        };
        check_length("must_contain", self.must_contain.len(), contained)?;
        for (index, (dual, bound)) in self.region.iter().zip(&system.region).enumerate() {
            let field = |key: &str| format!("region[{index}].{key}");
            let k = bound.rows.nrows();
            symmetric(&field("state"), &dual.state, n)?;
            shape(&field("cross"), &dual.cross, (n, k))?;
            symmetric(&field("unit"), &dual.unit, k)?;
        }
        for (index, dual) in self.must_contain.iter().enumerate() {
            symmetric(&format!("must_contain[{index}]"), dual, n)?;
        }
        let mut gains = vec![self.first_gain(model, sizes)?];
        if given.is_empty() {
            check_length("further_gains", self.further_gains.len(), 0)?;
        }
        for (index, further) in self.further_gains.iter().enumerate() {
            let duals = further.duals(sizes);
            gains.push(duals.map_err(|error| error.within(&format!("further_gains[{index}]")))?);
        }
        Ok(DualMultipliers {
            given: given.to_vec(),
            containment_weight: self.containment(contained > 0)?,
            gains,
            region: self.region.clone(),
            must_contain: self.must_contain.clone(),
        })
    }

    /// The dual multipliers of the only or first gain.
    fn first_gain(&self, model: &Model, sizes: Sizes) -> Result<GainDuals, ModelError> {
        let (n, given) = (sizes.states, sizes.given > 0);
        let gain = match self.gain {
            Some(gain) if given => numbered("gain", gain, sizes.given)?,
            Some(gain) => {
                return Err(ModelError::OutOfRange {
                    field: "gain".to_string(),
                    value: (gain + 1) as f64,
                    allowed: "left out: no gains are given".to_string(),
                })
            }
            None if given => return Err(missing("gain", "the number of a gain")),
            None => 0,
        };
        let duals = GainDuals {
            gain,
            start: self.decrease_start.clone(),
            end: self.decrease_end.clone(),
            integral: self.integral.clone(),
            integral_cross: None,
            inputs: self.anti_windup.clone(),
        };
        check_gain(&duals, sizes)?;
        let because = match (&duals.end.multiplied_sample, &duals.end.held) {
            (None, _) if model.file.specs.eps[2] == 0.0 => "eps[2] is 0",
            (None, None) if given => "there is no held state",
            _ => return Ok(duals),
        };
        let expected = format!("{n} x {n}, because {because}");
        Err(missing("decrease_end.multiplied_sample", &expected))
    }

    fn containment(&self, needed: bool) -> Result<f64, ModelError> {
        match (needed, self.containment_weight) {
            (true, Some(weight)) => Ok(weight),
            (true, None) => Err(missing(
                "containment_weight",
                "a number above 0, because the model has must_contain states",
            )),
            (false, Some(value)) => Err(ModelError::OutOfRange {
                field: "containment_weight".to_string(),
                value,
                allowed: "left out: the model has no must_contain states".to_string(),
            }),
            (false, None) => Ok(1.0),
        }
    }
}

impl GainWeightsFile {
    fn duals(&self, sizes: Sizes) -> Result<GainDuals, ModelError> {
        let n = sizes.states;
        let duals = GainDuals {
            gain: numbered("gain", self.gain, sizes.given)?,
            start: self.decrease_start.clone(),
            end: self.decrease_end.clone(),
            integral: self.integral.clone(),
            integral_cross: Some(IntegralCross {
                state: self.state_integral.clone(),
                sample: self.sample_integral.clone(),
            }),
            inputs: self.anti_windup.clone(),
        };
        check_gain(&duals, sizes)?;
        if duals.end.multiplied_sample.is_none() {
            let expected = format!("{n} x {n}");
            return Err(missing("decrease_end.multiplied_sample", &expected));
        }
        shape("state_integral", &self.state_integral, (n, n))?;
        shape("sample_integral", &self.sample_integral, (n, n))?;
        Ok(duals)
    }
}

/// The shapes of what the dual multipliers of every gain have.
fn check_gain(duals: &GainDuals, sizes: Sizes) -> Result<(), ModelError> {
    let n = sizes.states;
    check_length("anti_windup", duals.inputs.len(), sizes.inputs)?;
    for (index, dual) in duals.inputs.iter().enumerate() {
        symmetric(&format!("anti_windup[{index}].state"), &dual.state, n)?;
    }
    check_moments("decrease_start", &duals.start, sizes)?;
    if duals.start.multiplied_sample.is_none() {
        let expected = format!("{n} x {n}");
        return Err(missing("decrease_start.multiplied_sample", &expected));
    }
    check_moments("decrease_end", &duals.end, sizes)?;
    symmetric("integral", &duals.integral, n)
}

fn check_moments(end: &str, moments: &Moments, sizes: Sizes) -> Result<(), ModelError> {
    let (n, m, d) = (sizes.states, sizes.inputs, sizes.disturbances);
    let field = |key: &str| format!("{end}.{key}");
    for (index, dual) in moments.vertices.iter().enumerate() {
        let field = field(&format!("vertices[{index}]"));
        numbered(&format!("{field}.vertex"), dual.vertex, sizes.vertices)?;
        symmetric(&format!("{field}.moments"), &dual.moments, 2 * n)?;
    }
    shape(&field("state_sample"), &moments.state_sample, (n, n))?;
    if let Some(multiplied) = &moments.multiplied_sample {
        shape(&field("multiplied_sample"), multiplied, (n, n))?;
    }
    symmetric(&field("sample"), &moments.sample, n)?;
    let driven = &moments.multiplied_disturbance;
    shape(&field("multiplied_disturbance"), driven, (n, d))?;
    symmetric(&field("disturbance"), &moments.disturbance, d)?;
    if let Some(held) = &moments.held {
        shape(
            &field("held.multiplied_held"),
            &held.multiplied_held,
            (n, n),
        )?;
        shape(&field("held.sample_held"), &held.sample_held, (n, n))?;
        symmetric(&field("held.held"), &held.held, n)?;
    }
    let given = sizes.given > 0;
    if moments.dead_zone.is_some() != given {
        return Err(ModelError::WrongShape {
            field: field("dead_zone"),
            found: if given { "nothing" } else { "moments" }.to_string(),
            expected: "moments of the dead zone exactly where gains are given".to_string(),
        });
    }
    if let Some(zone) = &moments.dead_zone {
        shape(
            &field("dead_zone.multiplied_zone"),
            &zone.multiplied,
            (n, m),
        )?;
        shape(&field("dead_zone.held_zone"), &zone.held, (n, m))?;
        symmetric(&field("dead_zone.zone"), &zone.own, m)?;
    }
    Ok(())
}

/// An index that files number from 1.
fn numbered(field: &str, index: usize, count: usize) -> Result<usize, ModelError> {
    match index < count {
        true => Ok(index),
        false => Err(ModelError::OutOfRange {
            field: field.to_string(),
            value: (index + 1) as f64,
            allowed: format!("1 to {count}"),
        }),
    }
}

fn missing(field: &str, expected: &str) -> ModelError {
    ModelError::WrongShape {
        field: field.to_string(),
        found: "nothing".to_string(),
        expected: expected.to_string(),
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

fn shape(field: &str, matrix: &DMatrix<f64>, size: (usize, usize)) -> Result<(), ModelError> {
    if matrix.shape() == size {
        return Ok(());
    }
    Err(ModelError::WrongShape {
        field: field.to_string(),
        found: format!("{} x {}", matrix.nrows(), matrix.ncols()),
        expected: format!("{} x {}", size.0, size.1),
    })
}

fn symmetric(field: &str, matrix: &DMatrix<f64>, side: usize) -> Result<(), ModelError> {
    shape(field, matrix, (side, side))?;
    check_symmetric(field, matrix)
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

    /// The given gains whose conditions have dual multipliers, numbered from 1: together they cannot hold. Empty
    /// where no gains are given.
    pub fn blocking_gains(&self) -> Vec<usize> {
        let sets = self.infeasibility.iter();
        let gains = sets.flat_map(|set| {
            let further = set.further_gains.iter().map(|weights| weights.gain);
            set.gain.into_iter().chain(further).map(|index| index + 1)
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

    /// The numbers, every set of dual multipliers.
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
