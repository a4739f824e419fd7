//! Checks of parameters that are matrices.

use nalgebra::SMatrix;

use crate::error::{AllowedRange, Field, ParameterError};

/// Largest difference between mirrored entries of a symmetric matrix, relative to its largest entry.
pub const SYMMETRY_TOLERANCE: f64 = 1e-9;

/// Checks that a matrix is finite, symmetric up to [`SYMMETRY_TOLERANCE`] and positive definite.
pub(crate) fn require_positive_definite<const N: usize>(
    name: &'static str,
    matrix: &SMatrix<f64, N, N>,
) -> Result<(), ParameterError> {
    AllowedRange::FINITE.check_entries(matrix, |row, column| Field::entry(name, row, column))?;
    let columns = matrix.data.0;
    let rows = matrix.transpose().data.0;
    let entries = columns.iter().flatten();
    let largest = entries.fold(0.0_f64, |largest, value| largest.max(value.abs()));
    for (row, (above, below)) in rows.iter().zip(&columns).enumerate() {
        let pairs = above.iter().zip(below).enumerate().skip(row + 1);
        for (column, (&value, &mirrored)) in pairs {
            if (value - mirrored).abs() > SYMMETRY_TOLERANCE * largest {
                return Err(ParameterError::NotSymmetric {
                    field: Field::entry(name, row, column),
                    value,
                    mirrored,
                });
            }
        }
    }
    check_pivots(name, columns)
}

/// Gaussian elimination of a symmetric matrix; every pivot must be positive.
fn check_pivots<const N: usize>(
    name: &'static str,
    mut columns: [[f64; N]; N],
) -> Result<(), ParameterError> {
    for k in 0..N {
        let eliminated = columns[k];
        let pivot = eliminated[k];
        if !(pivot > 0.0 && pivot.is_finite()) {
            return Err(ParameterError::NotPositiveDefinite {
                field: Field::entry(name, k, k),
                pivot,
            });
        }
        for column in columns.iter_mut().skip(k + 1) {
            let ratio = column[k] / pivot;
            for (value, entry) in column.iter_mut().zip(&eliminated).skip(k + 1) {
                *value -= ratio * entry;
            }
        }
    }
    Ok(())
}
