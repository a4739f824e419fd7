//! Gains that come from elsewhere.

use nalgebra::DMatrix;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::bounded::{As, Rows};
use super::command_trigger::GivenTrigger;
use super::ranges::{check_count, check_line, check_shape, check_version};
use super::{parse, FileError, Kind, ModelError};

/// The version this program reads.
pub const GAINS_SCHEMA_VERSION: u32 = 1;

/// Largest number of gains.
const MAX_GAINS: usize = 64;

/// Given gains, to be analysed on a model. n states, m inputs. The trigger weight is not given: the
/// analysis chooses the best one; or the gains come with a trigger of their own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GainsFile {
    /// Version of this format: 1.
    pub schema_version: u32,
    /// A short name, used in reports.
    pub name: String,
    /// Where the numbers come from.
    #[serde(default)]
    pub source: String,
    /// The gains F_j, each m x n: one for a constant gain; as many as the model has rules for gains
    /// scheduled by its memberships; any other number is analysed for every mixture of them.
    #[serde(with = "As::<Vec<Rows>>")]
    pub gains: Vec<DMatrix<f64>>,
    /// The trigger that the gains are used with; one on the state, which the analysis chooses, when left out. Only with
    /// one gain.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trigger: Option<GivenTrigger>,
}

impl GainsFile {
    /// Reads and checks the text of a gains file.
    pub fn from_json(text: &str) -> Result<Self, FileError> {
        let file: GainsFile = parse(text, Kind::Gains)?;
        file.check()?;
        Ok(file)
    }

    fn check(&self) -> Result<(), ModelError> {
        check_version(self.schema_version, GAINS_SCHEMA_VERSION)?;
        check_line("name", &self.name)?;
        check_count("gains", "gains", self.gains.len(), MAX_GAINS)?;
        let Some(first) = self.gains.first() else {
            return Err(ModelError::shape("gains", "0 gains", "at least 1 gain"));
        };
        let mut expected = (None, None);
        for (index, gain) in self.gains.iter().enumerate() {
            check_shape(&format!("gains[{index}]"), gain, expected)?;
            expected = (Some(first.nrows()), Some(first.ncols()));
        }
        if self.trigger.is_some() && self.gains.len() > 1 {
            let found = format!("{} gains", self.gains.len());
            return Err(ModelError::shape("gains", found, "1 gain with a trigger"));
        }
        Ok(())
    }

    /// Refuses gains that are not of the size m x n of a model.
    pub fn check_size(&self, inputs: usize, states: usize) -> Result<(), ModelError> {
        let mut gains = self.gains.iter();
        match gains.find(|gain| gain.shape() != (inputs, states)) {
            None => Ok(()),
            Some(gain) => Err(ModelError::shape(
                "gains[0]",
                format!("{} x {}", gain.nrows(), gain.ncols()),
                format!("{inputs} x {states} for this model"),
            )),
        }
    }
}
