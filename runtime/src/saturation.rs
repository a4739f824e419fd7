//! Torque saturation per axis and its dead zone.

use nalgebra::SVector;

use crate::error::{AllowedRange, ParameterError};

/// Symmetric limits on each of `M` actuated axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Saturation<const M: usize> {
    limit: SVector<f64, M>,
}

impl<const M: usize> Saturation<M> {
    /// Limits in N m (or the plant's input unit), one per axis.
    ///
    /// # Errors
    /// A limit that is not finite or not positive.
    pub fn new(limit: SVector<f64, M>) -> Result<Self, ParameterError> {
        AllowedRange::POSITIVE.check_vector("torque_limit", &limit)?;
        Ok(Self { limit })
    }

    /// The limits, N m.
    pub fn limit(&self) -> &SVector<f64, M> {
        &self.limit
    }

    /// Saturated torque: sat(u) of Xu and Huang 2020, (4), axis by axis.
    ///
    /// Infinities saturate; a component that is not a number stays so.
    pub fn saturate(&self, torque: &SVector<f64, M>) -> SVector<f64, M> {
        torque.zip_map(&self.limit, |value, limit| {
            if value > limit {
                limit
            } else if value < -limit {
                -limit
            } else {
                value
            }
        })
    }

    /// Dead zone: the part of the torque that saturation cuts off, Xu and Huang 2020, (6), so that
    /// `saturate(u) = u - dead_zone(u)`.
    pub fn dead_zone(&self, torque: &SVector<f64, M>) -> SVector<f64, M> {
        torque.zip_map(&self.limit, |value, limit| {
            if value > limit {
                value - limit
            } else if value < -limit {
                value + limit
            } else {
                0.0
            }
        })
    }
}
