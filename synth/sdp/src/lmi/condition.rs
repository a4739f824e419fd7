//! Named matrix inequalities, the margin of strict ones, and problems made of them.

use nalgebra::DMatrix;

use super::{Affine, Unknowns};

/// A named matrix inequality. It is kept as `G(y) >= 0`: the margin of a strict inequality is
/// already inside G.
#[derive(Debug, Clone)]
pub struct Condition {
    name: String,
    expression: Affine,
}

impl Condition {
    /// `X > 0`, stated as `X >= margin I`. The margin is in the units of X.
    pub fn positive(name: impl Into<String>, x: Affine, margin: f64) -> Self {
        let shift = Affine::identity(x.nrows(), margin);
        Condition::semidefinite(name, x - shift)
    }

    /// `X < 0`, stated as `X <= -margin I`.
    pub fn negative(name: impl Into<String>, x: Affine, margin: f64) -> Self {
        Condition::positive(name, -x, margin)
    }

    /// `X >= 0`.
    pub fn semidefinite(name: impl Into<String>, x: Affine) -> Self {
        assert!(
            x.is_symmetric(),
            "a matrix inequality needs a symmetric matrix"
        );
        Condition {
            name: name.into(),
            expression: x,
        }
    }

    /// The name, such as `decrease r=1 vertex 3`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Side of the matrix.
    pub fn side(&self) -> usize {
        self.expression.nrows()
    }

    /// The matrix G of `G(y) >= 0`.
    pub fn expression(&self) -> &Affine {
        &self.expression
    }
}

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

/// `minimise objective(y)` subject to all conditions.
#[derive(Debug, Clone)]
pub struct LmiProblem {
    /// The unknowns of every expression below.
    pub unknowns: Unknowns,
    /// The objective, 1 x 1.
    pub objective: Affine,
    /// The conditions; their order is kept by every backend and file writer.
    pub conditions: Vec<Condition>,
}
