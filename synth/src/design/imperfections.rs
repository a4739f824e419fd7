//! The part of a certificate that only a loop with imperfections needs.

use nalgebra::DMatrix;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::matrices::{positive_list, rows, symmetric};
use crate::certify::theorem1::{FinalBounds, FirstTorque, MeasurementWeights};
use crate::model::{check_matrix, check_positive, Model, ModelError, Plant};

/// What a measurement error d with d'Lam d <= s needs beside the trigger weight. n states.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeasurementFile {
    /// Wp: what is left of the trigger weight on the error. n x n, symmetric.
    pub error_weight: Vec<Vec<f64>>,
    /// Diagonal of Lam. n entries.
    pub sample_weight: Vec<f64>,
}

/// The functional before the first message arrives. n states, d disturbances.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FirstTorqueFile {
    /// kappa: V' <= kappa V + xi |tau|^2 [1/s].
    pub growth_per_s: f64,
    /// Multiplier of x. n x n.
    pub state: Vec<Vec<f64>>,
    /// Multiplier of x'. n x n.
    pub rate: Vec<Vec<f64>>,
    /// Multiplier of the disturbance. d x n.
    pub disturbance: Vec<Vec<f64>>,
}

/// Bounds from rest, and in the end from every certified start.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FinalBoundsFile {
    /// On the norm of the rate [rad/s].
    pub rate_rad_s: f64,
    /// On the norm of the error quaternion's vector part.
    pub vector_part: f64,
}

impl MeasurementFile {
    pub(super) fn of(weights: &MeasurementWeights) -> Self {
        MeasurementFile {
            error_weight: rows(&weights.error_weight),
            sample_weight: weights.sample_weight.iter().copied().collect(),
        }
    }

    pub(super) fn read(&self, states: usize) -> Result<MeasurementWeights, ModelError> {
        let field = "certificate.measurement.error_weight";
        Ok(MeasurementWeights {
            error_weight: symmetric(field, &self.error_weight, states)?,
            sample_weight: positive_list(
                "certificate.measurement.sample_weight",
                &self.sample_weight,
                states,
            )?,
        })
    }
}

impl FirstTorqueFile {
    pub(super) fn of(numbers: &FirstTorque) -> Self {
        FirstTorqueFile {
            growth_per_s: numbers.growth,
            state: rows(&numbers.state),
            rate: rows(&numbers.rate),
            disturbance: rows(&numbers.disturbance),
        }
    }

    pub(super) fn read(
        &self,
        (states, disturbances): (usize, usize),
    ) -> Result<FirstTorque, ModelError> {
        check_positive("certificate.first_torque.growth_per_s", self.growth_per_s)?;
        let matrix = |key: &str, rows: &[Vec<f64>], height: usize| -> Result<DMatrix<f64>, _> {
            let field = format!("certificate.first_torque.{key}");
            check_matrix(&field, rows, (Some(height), Some(states)))
        };
        Ok(FirstTorque {
            growth: self.growth_per_s,
            state: matrix("state", &self.state, states)?,
            rate: matrix("rate", &self.rate, states)?,
            disturbance: matrix("disturbance", &self.disturbance, disturbances)?,
        })
    }
}

impl FinalBoundsFile {
    /// The bounds of a certificate.
    pub(crate) fn of(bounds: &FinalBounds) -> Self {
        FinalBoundsFile {
            rate_rad_s: bounds.rate,
            vector_part: bounds.vector_part,
        }
    }

    /// The bounds, where the plant is one that has them.
    pub(crate) fn read(&self, model: &Model) -> Result<FinalBounds, ModelError> {
        let Plant::Spacecraft(_) = model.plant else {
            let reason = "must be left out: the plant is not an exact spacecraft";
            return Err(ModelError::choice("certificate.final_bounds", reason));
        };
        check_positive("certificate.final_bounds.rate_rad_s", self.rate_rad_s)?;
        check_positive("certificate.final_bounds.vector_part", self.vector_part)?;
        Ok(FinalBounds {
            rate: self.rate_rad_s,
            vector_part: self.vector_part,
        })
    }
}

/// Numbers stand in a certificate exactly where the model needs them.
pub(super) fn present(key: &str, found: bool, needed: bool) -> Result<(), ModelError> {
    let field = format!("certificate.{key}");
    match (found, needed) {
        (false, true) => Err(ModelError::choice(
            field,
            "is missing; the model's imperfections need it",
        )),
        (true, false) => Err(ModelError::choice(
            field,
            "must be left out: the model's imperfections do not need it",
        )),
        _ => Ok(()),
    }
}
