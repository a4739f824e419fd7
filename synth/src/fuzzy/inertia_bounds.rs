//! The set of an uncertain inertia, in exact or interval arithmetic.

use nalgebra::Matrix3;

use super::ExactSpacecraft;
use verified::matrix::Matrix;
use verified::scalar::Scalar;

/// The vertices of the inertia's set: every combination of J_ij -+ (percent / 100 |J_ij| + amount), each
/// enclosed. Their convex hull holds every inertia of the set.
pub(crate) fn inertia_vertices<S: Scalar>(craft: &ExactSpacecraft) -> Vec<Matrix<S>> {
    let nominal: Matrix<S> = exact_inertia(&craft.inertia);
    let uncertainty = &craft.inertia_uncertainty;
    let entries = uncertainty.uncertain_entries(&craft.inertia);
    let mut out = vec![nominal];
    for (row, column) in entries {
        let width = half_width::<S>(craft, (row, column));
        let lowered = out.iter().map(|inertia| {
            let low = inertia.at(row, column).clone() - width.clone();
            with_entry(inertia, (row, column), low)
        });
        let raised = out.iter().map(|inertia| {
            let high = inertia.at(row, column).clone() + width.clone();
            with_entry(inertia, (row, column), high)
        });
        out = lowered.chain(raised).collect();
    }
    out
}

/// percent / 100 |J_ij| + amount.
fn half_width<S: Scalar>(craft: &ExactSpacecraft, entry: (usize, usize)) -> S {
    let (percent, amount) = craft.inertia_uncertainty.of_entry(entry);
    let magnitude = S::from_f64(craft.inertia[entry].abs());
    S::from_f64(percent) * magnitude / S::from_f64(100.0) + S::from_f64(amount)
}

/// A symmetric matrix with one entry, and its mirror, replaced.
fn with_entry<S: Scalar>(matrix: &Matrix<S>, (row, column): (usize, usize), value: S) -> Matrix<S> {
    let mut out = matrix.clone();
    out.set(row, column, value.clone());
    out.set(column, row, value);
    out
}

/// Matrices that, positive definite, show that the whole set of inertias is: `J0 - T W T` with W the
/// half-widths and T = diag(1, +-1, +-1). For every J of the set and every x, with T the signs of x,
/// `x'Jx >= x'J0 x - |x|'W|x| = x'(J0 - T W T)x`. Empty for an inertia that is known, which was checked
/// when the model was read.
pub fn inertia_bounds<S: Scalar>(craft: &ExactSpacecraft) -> Vec<Matrix<S>> {
    let entries = craft.inertia_uncertainty.uncertain_entries(&craft.inertia);
    if entries.is_empty() {
        return Vec::new();
    }
    let signs = [[false, false], [false, true], [true, false], [true, true]];
    let bound = |[second, third]: [bool; 2]| {
        let negative = [false, second, third];
        let nominal: Matrix<S> = exact_inertia(&craft.inertia);
        entries.iter().fold(nominal, |out, &(row, column)| {
            let width = half_width::<S>(craft, (row, column));
            let entry = out.at(row, column).clone();
            let lowered = match negative[row] == negative[column] {
                true => entry - width,
                false => entry + width,
            };
            with_entry(&out, (row, column), lowered)
        })
    };
    signs.map(bound).into_iter().collect()
}

/// The nominal inertia, exactly.
pub(crate) fn exact_inertia<S: Scalar>(inertia: &Matrix3<f64>) -> Matrix<S> {
    Matrix::from_fn(3, 3, |r, c| S::from_f64(inertia[(r, c)]))
}
