//! Inertias of a file: checked, or drawn from a set.

use nalgebra::Matrix3;
use synth::model::{ExactPlant, Model, ModelFile, PlantFile, Specs};
use synth::model::{InertiaUncertaintyFile, ModelError, Plant};

use crate::sim::random::{Purpose, Random};

/// An inertia drawn from the set about `rows`, every entry uniform and independent of the others.
pub(crate) fn drawn(
    rows: &[[f64; 3]; 3],
    set: &InertiaUncertaintyFile,
    seed: u64,
) -> Result<Matrix3<f64>, ModelError> {
    let plant = spacecraft(rows, Some(*set)).map_err(|error| {
        let error = relocated(error, "plant.exact.inertia_uncertainty", DRAWN);
        relocated(error, "plant.exact.", "")
    })?;
    let nominal = Matrix3::from_fn(|r, c| rows[r][c]);
    let mut random = Random::new(seed, Purpose::Inertia);
    let places = std::array::from_fn(|_| random.uniform());
    Ok(match plant {
        Plant::Spacecraft(craft) => craft.inertia_uncertainty.member(&nominal, &places),
        // What is given above is a spacecraft.
        Plant::Vertices(_) | Plant::Rules(_) => nominal,
    })
}

/// The key of the set.
const DRAWN: &str = "inertia_drawn_within";

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

/// The same rules as for the inertia of a model file.
pub(crate) fn inertia(rows: &[[f64; 3]; 3]) -> Result<Matrix3<f64>, ModelError> {
    spacecraft(rows, None).map_err(|error| relocated(error, "plant.exact.", ""))?;
    Ok(Matrix3::from_fn(|r, c| rows[r][c]))
}

/// A spacecraft of which only the inertia plays a part; errors are those of a model file.
pub(crate) fn spacecraft(
    rows: &[[f64; 3]; 3],
    inertia_uncertainty: Option<InertiaUncertaintyFile>,
) -> Result<Plant, ModelError> {
    let model = placeholder(PlantFile::Exact(ExactPlant {
        inertia_kg_m2: *rows,
        inertia_uncertainty,
        torque_limit_nm: [1.0; 3],
        disturbance_bound_nm: 0.0,
        rate_rad_s: [1.0; 3],
        q0_min: 0.5,
    }));
    Ok(Model::new(model)?.plant)
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
