//! Matrices and lists of numbers as files hold them.

use nalgebra::{DMatrix, DVector};

use crate::model::{check_matrix, check_positive, check_symmetric, ModelError};

/// A matrix as a file holds it: a list of rows.
pub(crate) fn rows(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let row = |r: usize| matrix.row(r).iter().copied().collect();
    (0..matrix.nrows()).map(row).collect()
}

/// The matrix that rows of equal length hold.
pub(crate) fn matrix(rows: &[Vec<f64>]) -> DMatrix<f64> {
    let columns = rows.first().map_or(0, Vec::len);
    DMatrix::from_fn(rows.len(), columns, |r, c| {
        rows[r].get(c).copied().unwrap_or(f64::NAN)
    })
}

/// A symmetric matrix with this side.
pub(crate) fn symmetric(
    field: &str,
    rows: &[Vec<f64>],
    side: usize,
) -> Result<DMatrix<f64>, ModelError> {
    let matrix = check_matrix(field, rows, (Some(side), Some(side)))?;
    check_symmetric(field, &matrix)?;
    Ok(matrix)
}

/// A list of numbers above 0, of this length.
pub(crate) fn positive_list(
    field: &str,
    list: &[f64],
    length: usize,
) -> Result<DVector<f64>, ModelError> {
    if list.len() != length {
        let [found, expected] = [list.len(), length].map(|count| format!("{count} entries"));
        return Err(ModelError::shape(field, found, expected));
    }
    for (index, &value) in list.iter().enumerate() {
        check_positive(&format!("{field}[{index}]"), value)?;
    }
    Ok(DVector::from_column_slice(list))
}
