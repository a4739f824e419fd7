//! A model around a plant alone, to check the plant with the model's checks.

use synth::model::ModelError;
use synth::model::{ModelFile, PlantFile, Specs};

/// Specifications that play no part: only the plant of the model is used.
pub(crate) fn placeholder(plant: PlantFile) -> ModelFile {
    ModelFile {
        schema_version: synth::model::MODEL_SCHEMA_VERSION,
        name: String::new(),
        source: String::new(),
        plant,
        specs: Specs {
            phi_per_s: 1.0,
            hbar_s: 1.0,
            hmin_s: None,
            nu: 0.0,
            nu_min: None,
            threshold_update: None,
            eps: [1.0; 3],
            xi_max: 1.0,
            objective: Default::default(),
            must_contain: Vec::new(),
            outer: None,
            search: None,
            margin: 1e-6,
        },
        gains: Default::default(),
        mismatch: Default::default(),
    }
}

/// The same error at another place.
pub(crate) fn relocated(mut error: ModelError, from: &str, to: &str) -> ModelError {
    if let ModelError::OutOfRange { field, .. }
    | ModelError::WrongShape { field, .. }
    | ModelError::NotSymmetric { field, .. }
    | ModelError::NotPositiveDefinite { field, .. }
    | ModelError::Choice { field, .. } = &mut error
    {
        if let Some(rest) = field.strip_prefix(from) {
            *field = format!("{to}{rest}");
        }
    }
    error
}
