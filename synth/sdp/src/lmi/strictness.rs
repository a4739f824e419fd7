//! The margin of strict inequalities.

use nalgebra::DMatrix;

use super::{Affine, Condition};

/// The margin of the strict inequalities: a number, or an unknown that is maximised.
#[derive(Debug, Clone)]
pub struct Strictness(Affine);

impl Strictness {
    /// A fixed margin.
    pub fn fixed(margin: f64) -> Self {
        Strictness(Affine::identity(1, margin))
    }

    /// A margin that is itself a scalar expression.
    pub fn unknown(margin: Affine) -> Self {
        Strictness(margin)
    }

    /// `x >= margin I`.
    pub fn positive(&self, name: impl Into<String>, x: Affine) -> Condition {
        let weight = DMatrix::identity(x.nrows(), x.nrows());
        self.positive_against(name, x, &weight)
    }

    /// `x >= margin * weight` for a constant symmetric weight.
    pub fn positive_against(
        &self,
        name: impl Into<String>,
        x: Affine,
        weight: &DMatrix<f64>,
    ) -> Condition {
        Condition::semidefinite(name, x - self.0.times_matrix(weight))
    }
}
