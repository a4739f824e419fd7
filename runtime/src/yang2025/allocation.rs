//! From a torque about the body axes to `M` actuators and back.

use nalgebra::{SMatrix, SVector, Vector3};

use crate::error::{AllowedRange, Field, ParameterError};
use crate::saturation::Saturation;

/// Name of the actuator matrix in errors.
const MATRIX: &str = "actuator_matrix";

/// Smallest determinant of D0 D0' that counts as full rank, relative to the cube of its mean diagonal.
const SMALLEST_DETERMINANT: f64 = 1e-9;

/// The nominal actuators: the matrix D0 with its pseudo-inverse, and their limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Allocation<const M: usize> {
    matrix: SMatrix<f64, 3, M>,
    inverse: SMatrix<f64, M, 3>,
    saturation: Saturation<M>,
}

impl<const M: usize> Allocation<M> {
    /// Actuators whose columns in `matrix` (3 x M, dimensionless) are the torques about the body axes
    /// that a unit torque of each gives, with their limits in N m.
    ///
    /// # Errors
    /// An entry that is not finite, a matrix that does not reach every axis, a limit that is not
    /// positive.
    pub fn new(matrix: SMatrix<f64, 3, M>, limit: SVector<f64, M>) -> Result<Self, ParameterError> {
        let entry = |row, column| Field::entry(MATRIX, row, column);
        AllowedRange::FINITE.check_entries(&matrix, entry)?;
        let square = matrix * matrix.transpose();
        let scale = square.trace() / 3.0;
        let determinant = square.determinant() / (scale * scale * scale);
        let inverse = square.try_inverse();
        match inverse {
            Some(inverse) if determinant >= SMALLEST_DETERMINANT => Ok(Self {
                matrix,
                inverse: matrix.transpose() * inverse,
                saturation: Saturation::new(limit)?,
            }),
            _ => Err(ParameterError::RankDeficient {
                field: entry(0, 0),
                determinant: if determinant.is_finite() {
                    determinant
                } else {
                    0.0
                },
            }),
        }
    }

    /// The commands of least norm that give `torque` (N m about the body axes), within the limits.
    pub fn command(&self, torque: &Vector3<f64>) -> SVector<f64, M> {
        self.saturation.saturate(&(self.inverse * torque))
    }

    /// The nominal torque about the body axes, N m, of commands.
    pub fn torque(&self, command: &SVector<f64, M>) -> Vector3<f64> {
        self.matrix * command
    }

    /// From a torque about the body axes to the actuators, before saturation (M x 3).
    pub fn inverse(&self) -> &SMatrix<f64, M, 3> {
        &self.inverse
    }

    /// The limits, N m.
    pub fn limit(&self) -> &SVector<f64, M> {
        self.saturation.limit()
    }

    /// The largest torque about each body axis alone, N m, that [`Self::command`] gives without
    /// saturating: u_max in (11) when every actuator has an axis of its own.
    pub fn authority(&self) -> Vector3<f64> {
        let columns = self.inverse.column_iter().map(|column| {
            let ratios = column.iter().zip(self.limit().iter());
            ratios.fold(f64::INFINITY, |least, (share, limit)| {
                let share = share.abs();
                if share > 0.0 {
                    least.min(limit / share)
                } else {
                    least
                }
            })
        });
        Vector3::from_iterator(columns)
    }
}
