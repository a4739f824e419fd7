//! Small vectors and matrices inside larger ones of fixed size, the rest zero.

use nalgebra::{DMatrix, SMatrix, SVector};

/// The matrix in the upper left corner; what does not fit is left out.
pub fn matrix<const R: usize, const C: usize>(small: &DMatrix<f64>) -> SMatrix<f64, R, C> {
    SMatrix::from_fn(|r, c| small.get((r, c)).copied().unwrap_or(0.0))
}

/// As [`matrix`], with ones on the rest of the diagonal.
pub fn with_unit_diagonal<const N: usize>(small: &DMatrix<f64>) -> SMatrix<f64, N, N> {
    SMatrix::from_fn(|r, c| match small.get((r, c)) {
        Some(&value) => value,
        None if r == c => 1.0,
        None => 0.0,
    })
}

/// The vector's entries first.
pub fn vector<const N: usize>(small: &[f64]) -> SVector<f64, N> {
    filled(small, 0.0)
}

/// The vector's entries first, then `rest`.
pub fn filled<const N: usize>(small: &[f64], rest: f64) -> SVector<f64, N> {
    SVector::from_fn(|row, _| small.get(row).copied().unwrap_or(rest))
}
