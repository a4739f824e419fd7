//! The infeasibility certificate, as written, and its check.

use nalgebra::DMatrix;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::certify::infeasible::{
    check_length, missing, refute, refute_exactly, DualMultipliers, GainDuals, InputDual, Moments,
    Refutation, RegionDual,
};
use crate::certify::{decide_all, ExactReport};
use crate::design::{rows, Provenance};
use crate::model::bounded::{As, Positive, Rows};
use crate::model::{
    check_matrix, check_version, parse, FileError, Kind, Model, ModelError, ModelFile,
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
    /// Number of the given gain, from 1, that the next four keys are about; left out without given gains.
    #[serde(default, skip_serializing_if = "Option::is_none")]
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
    pub further_gains: Vec<GainDuals>,
    /// Dual multipliers of the region's conditions, in their order.
    pub region: Vec<RegionDual>,
    /// Dual multipliers of the containment conditions, one for each state: n x n, symmetric.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[serde(with = "As::<Vec<Rows>>")]
    pub must_contain: Vec<DMatrix<f64>>,
}

impl WeightsFile {
    /// The numbers as a reader of the file gets them, `None` without dual multipliers of a gain or where no file may
    /// hold them.
    pub(crate) fn new(duals: DualMultipliers) -> Option<Self> {
        let contains = !duals.must_contain.is_empty();
        let given = !duals.given.is_empty();
        let mut gains = duals.gains.into_iter();
        let first = gains.next()?;
        let written = WeightsFile {
            containment_weight: contains.then_some(duals.containment_weight),
            gain: given.then_some(first.gain),
            decrease_start: first.start,
            decrease_end: first.end,
            integral: first.integral,
            anti_windup: first.inputs,
            further_gains: gains.collect(),
            region: duals.region,
            must_contain: duals.must_contain,
        };
        serde_json::from_value(serde_json::to_value(written).ok()?).ok()
    }

    /// The numbers, checked.
    pub(crate) fn weights(
        &self,
        model: &Model,
        given: &[DMatrix<f64>],
    ) -> Result<DualMultipliers, ModelError> {
        // Without them the statement is about every rho.
        let contained = match self.must_contain.is_empty() && self.containment_weight.is_none() {
            true => 0,
            false => model.file.specs.must_contain.len(),
        };
        check_length("must_contain", self.must_contain.len(), contained)?;
        let first = GainDuals {
            gain: self.first_gain(!given.is_empty())?,
            start: self.decrease_start.clone(),
            end: self.decrease_end.clone(),
            integral: self.integral.clone(),
            state_integral: None,
            sample_integral: None,
            inputs: self.anti_windup.clone(),
        };
        if given.is_empty() {
            check_length("further_gains", self.further_gains.len(), 0)?;
        }
        let further = self.further_gains.iter().cloned();
        let duals = DualMultipliers {
            given: given.to_vec(),
            containment_weight: self.containment(contained > 0)?,
            gains: std::iter::once(first).chain(further).collect(),
            region: self.region.clone(),
            must_contain: self.must_contain.clone(),
        };
        duals.check(model)?;
        Ok(duals)
    }

    /// The first gain; left out exactly where no gains are given.
    fn first_gain(&self, given: bool) -> Result<usize, ModelError> {
        match self.gain {
            Some(gain) if given => Ok(gain),
            Some(gain) => {
                let allowed = "left out: no gains are given";
                Err(ModelError::range("gain", gain as f64, allowed))
            }
            None if given => Err(missing("gain", "the number of a given gain, from 1")),
            None => Ok(1),
        }
    }

    fn containment(&self, needed: bool) -> Result<f64, ModelError> {
        match (needed, self.containment_weight) {
            (true, Some(weight)) => Ok(weight),
            (true, None) => Err(missing(
                "containment_weight",
                "a number above 0, because the model has must_contain states",
            )),
            (false, Some(value)) => {
                let allowed = "left out: the model has no must_contain states";
                Err(ModelError::range("containment_weight", value, allowed))
            }
            (false, None) => Ok(1.0),
        }
    }
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
        check_version(file.schema_version, INFEASIBILITY_SCHEMA_VERSION)?;
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

    /// The numbers, every set of dual multipliers.
    pub fn weights(&self, model: &Model) -> Result<Vec<DualMultipliers>, ModelError> {
        if self.infeasibility.is_empty() {
            let found = "0 sets of weights";
            return Err(ModelError::shape("infeasibility", found, "at least 1"));
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

    /// Decides in exact rational arithmetic what [`InfeasibilityFile::verify`] found of each set of weights.
    pub fn verify_exactly(
        &self,
        model: &Model,
        found: &[Refutation],
    ) -> Result<ExactReport, ModelError> {
        let sets = self.weights(model)?;
        let pairs = sets.iter().zip(found);
        let reports = pairs.map(|(weights, found)| refute_exactly(model, weights, found));
        let none = decide_all(|_| ());
        Ok(reports.fold(none, ExactReport::and))
    }
}
