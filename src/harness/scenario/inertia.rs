//! An inertia that is drawn from a set.

use nalgebra::Matrix3;
use synth::model::{InertiaUncertaintyFile, ModelError, Plant};

use super::systems::{relocated, spacecraft};
use crate::harness::random::{Purpose, Random};

/// An inertia drawn from the set about `rows`, every entry uniform and independent of the others.
pub(super) fn drawn(
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
