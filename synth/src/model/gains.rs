//! Gains that come from elsewhere.

use nalgebra::DMatrix;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::ranges::{check_count, check_line};
use super::{check_matrix, parse, FileError, Kind, ModelError};

/// The version this program reads.
pub const GAINS_SCHEMA_VERSION: u32 = 1;

/// Largest number of gains.
const MAX_GAINS: usize = 64;

/// Given gains, to be analysed on a model. n states, m inputs. The trigger weight is not given: the
/// analysis chooses the best one.
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
    pub gains: Vec<Vec<Vec<f64>>>,
}

/// Checked gains.
#[derive(Debug, Clone, PartialEq)]
pub struct Gains {
    /// The file, unchanged.
    pub file: GainsFile,
    /// F_j, m x n each.
    pub gains: Vec<DMatrix<f64>>,
}

impl Gains {
    /// Reads and checks the text of a gains file.
    pub fn from_json(text: &str) -> Result<Self, FileError> {
        Ok(Gains::new(parse(text, Kind::Gains)?)?)
    }

    /// Checks every value.
    pub fn new(file: GainsFile) -> Result<Self, ModelError> {
        if file.schema_version != GAINS_SCHEMA_VERSION {
            return Err(ModelError::SchemaVersion {
                found: file.schema_version,
                expected: GAINS_SCHEMA_VERSION,
            });
        }
        check_line("name", &file.name)?;
        if file.gains.is_empty() {
            return Err(ModelError::WrongShape {
                field: "gains".to_string(),
                found: "0 gains".to_string(),
                expected: "at least 1 gain".to_string(),
            });
        }
        check_count("gains", "gains", file.gains.len(), MAX_GAINS)?;
        let mut gains = Vec::with_capacity(file.gains.len());
        let mut size = (None, None);
        for (index, rows) in file.gains.iter().enumerate() {
            let gain = check_matrix(&format!("gains[{index}]"), rows, size)?;
            size = (Some(gain.nrows()), Some(gain.ncols()));
            gains.push(gain);
        }
        Ok(Gains { file, gains })
    }

    /// Refuses gains that are not of the size m x n of a model.
    pub fn check_size(&self, inputs: usize, states: usize) -> Result<(), ModelError> {
        match self
            .gains
            .iter()
            .find(|gain| gain.shape() != (inputs, states))
        {
            None => Ok(()),
            Some(gain) => Err(ModelError::WrongShape {
                field: "gains[0]".to_string(),
                found: format!("{} x {}", gain.nrows(), gain.ncols()),
                expected: format!("{inputs} x {states} for this model"),
            }),
        }
    }
}
