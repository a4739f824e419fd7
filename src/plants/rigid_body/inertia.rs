//! Inertias of a file: checked, or drawn from a set.

use nalgebra::Matrix3;
use synth::model::{ExactPlant, InertiaUncertaintyFile, ModelError, Plant, PlantFile};

use crate::base::plant_model::relocated;
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
    Plant::new(&PlantFile::Exact(ExactPlant {
        inertia_kg_m2: *rows,
        inertia_uncertainty,
        torque_limit_nm: [1.0; 3],
        disturbance_bound_nm: 0.0,
        rate_rad_s: [1.0; 3],
        q0_min: 0.5,
    }))
}
