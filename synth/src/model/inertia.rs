//! The uncertain inertia of a model file.

use nalgebra::Matrix3;

use super::file::InertiaUncertaintyFile;
use super::ModelError;
use crate::fuzzy::{inertia_bounds, ExactSpacecraft, InertiaUncertainty, INERTIA_ENTRIES};
use verified::definite::{prove_positive_definite, IntervalMatrix};
use verified::interval::Interval;
use verified::matrix::Matrix;

const FIELD: &str = "plant.exact.inertia_uncertainty";

/// The numbers of the file, for a nominal inertia.
pub(super) fn inertia_uncertainty(
    file: &InertiaUncertaintyFile,
    nominal: &Matrix3<f64>,
) -> Result<InertiaUncertainty, ModelError> {
    let mut products = INERTIA_ENTRIES.iter().filter(|(row, column)| row != column);
    let diagonal = products.all(|&entry| nominal[entry] == 0.0);
    if diagonal && file.off_diagonal_percent > 0.0 && file.off_diagonal_kg_m2 == 0.0 {
        return Err(ModelError::choice(
            format!("{FIELD}.off_diagonal_percent"),
            "every off-diagonal entry of inertia_kg_m2 is 0, and a percentage of 0 is 0; give \
             off_diagonal_kg_m2 instead",
        ));
    }
    Ok(InertiaUncertainty {
        diagonal_percent: file.diagonal_percent,
        off_diagonal_percent: file.off_diagonal_percent,
        off_diagonal_amount: file.off_diagonal_kg_m2,
    })
}

/// Refuses a set that is not proved to hold positive definite matrices only.
pub(super) fn check_set(craft: &ExactSpacecraft) -> Result<(), ModelError> {
    let bounds = inertia_bounds::<Interval>(craft);
    if bounds.iter().all(is_proved) {
        return Ok(());
    }
    let smallest = |bound: &Matrix<Interval>| {
        let midpoint = Matrix3::from_fn(|r, c| bound.at(r, c).midpoint());
        midpoint.symmetric_eigenvalues().min()
    };
    let smallest = bounds.iter().map(smallest).fold(f64::INFINITY, f64::min);
    Err(ModelError::choice(
        FIELD,
        format!(
            "the set must hold positive definite inertias only; the smallest eigenvalue over it may be as \
             low as {smallest:.6} kg m^2"
        ),
    ))
}

fn is_proved(bound: &Matrix<Interval>) -> bool {
    let symmetric = IntervalMatrix::from_upper(bound.nrows(), |r, c| *bound.at(r, c));
    prove_positive_definite(&symmetric).is_ok()
}
