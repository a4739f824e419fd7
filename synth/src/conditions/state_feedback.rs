//! Design problems for a constant state feedback: what they have in common.
//!
//! The plant is `x' = A(t) x + B u` with A(t) anywhere in the convex hull of its vertices, the feedback
//! `u = F x`, the proof a quadratic function x'Px. A [`DesignProblem`] adds the rest: its inequalities
//! in the transformed unknowns Q = P^-1 and Y = F Q, in which they are linear; the number that it
//! guarantees; and the same inequalities in P and F, which are checked without any solver.

use std::collections::BTreeMap;

use nalgebra::DMatrix;

use super::units::{Sizes, Units};
pub use super::vertex_plant::VertexPlant;
use sdp::lmi::{Affine, Unknowns};
use verified::matrix::Matrix;
use verified::scalar::Scalar;

/// A problem for a [`VertexPlant`].
pub trait DesignProblem: Clone + Sized {
    /// The problem's key in a file, such as `h_infinity`.
    const NAME: &'static str;

    /// What is minimised, in terms of the guaranteed number.
    const OBJECTIVE: &'static str;

    /// What the guaranteed number is.
    const GUARANTEE: &'static str;

    /// True when a larger guaranteed number is the better one.
    const LARGER_IS_BETTER: bool = false;

    /// Names of further m x n gains that the proof needs, in alphabetical order. Synthesis has them as
    /// Z = H Q.
    const AUXILIARY_GAINS: &'static [&'static str] = &[];

    /// Units in which the problem's numbers are about 1, where its states, and what else is known, have these sizes.
    fn units(&self, plant: &VertexPlant, sizes: &Sizes) -> Units;

    /// The problem in other units.
    fn in_units(&self, units: &Units) -> Self;

    /// alpha [1/s], 0 or above: whatever else is asked for, at every vertex
    /// `A_i Q + Q A_i' + B Y + Y'B' + 2 alpha Q < 0` follows from the conditions.
    fn decay_rate(&self) -> f64;

    /// The conditions on the transformed unknowns, as published.
    fn conditions(&self, plant: &VertexPlant, transformed: &Transformed) -> Vec<Inequality>;

    /// The guaranteed number of an objective in the file's units: c of c^2, gamma itself, beta of 1/beta^2.
    fn guarantee_of(objective: f64) -> f64;

    /// The inverse of [`DesignProblem::guarantee_of`].
    fn objective_of(guarantee: f64) -> f64;

    /// The objective, in the file's units, below which nothing is looked for, with the name of that condition: the
    /// infimum may be 0. `None` where the objective is bounded by itself.
    fn floor(&self, _plant: &VertexPlant) -> Option<Floor> {
        None
    }

    /// True where the first auxiliary gain may be the feedback itself: with (Q, Y, Z) the conditions hold for (Q, Z, Z).
    const GAIN_IS_AUXILIARY: bool = false;

    /// With [`DesignProblem::GAIN_IS_AUXILIARY`], a faster feedback F for which the conditions hold as well, from P and
    /// the auxiliary gain, n x n and m x n.
    fn quickened(
        &self,
        _plant: &VertexPlant,
        _lyapunov: &DMatrix<f64>,
        auxiliary: &DMatrix<f64>,
    ) -> DMatrix<f64> {
        auxiliary.clone()
    }

    /// True where the feedback can be eliminated: the conditions then hold for some Y exactly where those do that are
    /// left of them, in Q alone.
    const ELIMINATES_GAIN: bool = false;

    /// Y, m x n, of a Q for which the conditions without feedback hold; `None` where there is none.
    fn completed(&self, _plant: &VertexPlant, _inverse: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        None
    }

    /// What is asked of the guaranteed number.
    fn wanted(&self) -> Wanted {
        Wanted::default()
    }

    /// The same problem with nothing asked of the guaranteed number.
    fn without_wanted(&self) -> Self {
        self.clone()
    }

    /// Designs that need no solver, for one vertex: the objective of each is proved or not by its check.
    fn direct(&self, _plant: &VertexPlant) -> Option<Box<dyn Direct + '_>> {
        None
    }

    /// Sets the number that a feedback guarantees, and the scale of P where the problem leaves it
    /// free. `objective` is what the solver reached; all is in the file's units.
    fn claim(&self, found: &mut StateFeedback, objective: f64);

    /// The conditions in P, F and the guaranteed number. Each matrix must be positive definite; together
    /// they are the whole proof.
    fn statements<S: Scalar>(&self, proof: &Proof<S>, emit: &mut dyn FnMut(String, Matrix<S>));

    /// A matrix that, positive definite, shows that no P > 0 satisfies the conditions with the plant's given feedback,
    /// from positive semidefinite multipliers Z_i of the decay conditions, not all zero: an exact refutation, whatever
    /// the size of P. `None` where the problem is not homogeneous in P or its feedback is sought.
    fn refutation<S: Scalar>(
        &self,
        _plant: &VertexPlant,
        _z: &[DMatrix<f64>],
    ) -> Option<Matrix<S>> {
        None
    }

    /// What the proof assumes, in words.
    fn assumptions(&self) -> Vec<String>;
}

/// A named matrix inequality in the unknowns: `matrix >= 0`, or `> 0` where it is strict.
#[derive(Debug, Clone)]
pub struct Inequality {
    /// Its name, such as `decay vertex 2`.
    pub name: String,
    /// The symmetric matrix.
    pub matrix: Affine,
    /// True for a strict one, which gets a margin.
    pub strict: bool,
}

impl Inequality {
    /// `matrix > 0`.
    pub fn strict(name: impl Into<String>, matrix: Affine) -> Self {
        Inequality {
            name: name.into(),
            matrix,
            strict: true,
        }
    }

    /// `matrix >= 0`.
    pub fn weak(name: impl Into<String>, matrix: Affine) -> Self {
        Inequality {
            strict: false,
            ..Inequality::strict(name, matrix)
        }
    }
}

/// Where the search for a smaller objective stops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Floor {
    /// The name of the condition.
    pub name: &'static str,
    /// The objective, in the file's units.
    pub objective: f64,
}

/// What a file asks of the guaranteed number beside the smallest one, in the file's units.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Wanted {
    /// A design with this number is wanted, not a smaller one.
    pub exactly: Option<f64>,
    /// The smallest number is wanted, and any up to this is a success.
    pub at_most: Option<f64>,
}

/// Designs of a problem that come from an equation in place of a semidefinite program.
pub trait Direct {
    /// The equation, for reports.
    fn name(&self) -> &'static str;

    /// The smallest objective at which the equation has a solution, or the floor.
    fn smallest(&self) -> Option<f64>;

    /// Candidates at an objective, those with the smallest gains first.
    fn candidates(&self, objective: f64) -> Box<dyn Iterator<Item = StateFeedback> + '_>;
}

/// The unknowns of synthesis.
#[derive(Debug, Clone)]
pub struct Transformed {
    /// Q = P^-1, n x n, symmetric.
    pub inverse: Affine,
    /// Y = F Q, m x n: unknown, or the given feedback times Q.
    pub gain: Affine,
    /// Z = H Q for every auxiliary gain, m x n each.
    pub auxiliary: Vec<Affine>,
    /// The number that is minimised, 1 x 1: unknown, or fixed while the margin is maximised.
    pub objective: Affine,
    /// An orthonormal basis of the vectors v with v'B = 0, n x k, where Y is eliminated.
    pub unreached: Option<DMatrix<f64>>,
}

impl Transformed {
    /// The unknowns of a problem; without Y where it is eliminated, which needs a feedback that is not given.
    pub fn new<P: DesignProblem>(
        unknowns: &mut Unknowns,
        plant: &VertexPlant,
        eliminated: bool,
    ) -> Self {
        let (n, m) = (plant.states(), plant.inputs());
        let inverse = unknowns.symmetric("Q", n);
        let own = plant.gain.is_none() && !eliminated && !P::GAIN_IS_AUXILIARY;
        let own = own.then(|| unknowns.general("Y", m, n));
        let auxiliary = P::AUXILIARY_GAINS.iter();
        let auxiliary: Vec<Affine> = auxiliary
            .map(|name| unknowns.general(&format!("{name} Q"), m, n))
            .collect();
        let shared = auxiliary.first().filter(|_| P::GAIN_IS_AUXILIARY).cloned();
        let gain = match &plant.gain {
            Some(given) => given * &inverse,
            None => own.or(shared).unwrap_or_else(|| Affine::zeros(m, n)),
        };
        let unreached = eliminated.then(|| left_null_space(&plant.input));
        Transformed {
            auxiliary,
            objective: unknowns.scalar("objective"),
            inverse,
            gain,
            unreached,
        }
    }

    /// Numbers in the place of the unknowns: Q, and Y (else no feedback, or the given one) with an objective; auxiliary
    /// gains are 0.
    pub fn at<P: DesignProblem>(
        plant: &VertexPlant,
        inverse: &DMatrix<f64>,
        gain: Option<&DMatrix<f64>>,
        objective: f64,
        eliminated: bool,
    ) -> Self {
        let none = DMatrix::zeros(plant.inputs(), plant.states());
        let given = plant.gain.as_ref().map(|given| given * inverse);
        Transformed {
            inverse: Affine::constant(inverse),
            gain: Affine::constant(given.as_ref().or(gain).unwrap_or(&none)),
            auxiliary: P::AUXILIARY_GAINS
                .iter()
                .map(|_| Affine::constant(&none))
                .collect(),
            objective: Affine::identity(1, objective),
            unreached: eliminated.then(|| left_null_space(&plant.input)),
        }
    }

    /// `A Q + Q A' + B Y + Y'B' + 2 alpha Q` with Y any transformed gain: negative where V decays at
    /// twice the rate alpha.
    pub fn decay(
        &self,
        vertex: &DMatrix<f64>,
        input: &DMatrix<f64>,
        gain: &Affine,
        rate: f64,
    ) -> Affine {
        let closed = vertex * &self.inverse + input * gain;
        closed.symmetrised() + 2.0 * rate * &self.inverse
    }
}

/// Columns of B below this size, relative to its largest singular value, count as dependent on others.
const RANK_TOLERANCE: f64 = 1e-10;

/// An orthonormal basis of the vectors v with v'B = 0, n x k.
fn left_null_space(input: &DMatrix<f64>) -> DMatrix<f64> {
    let gram = input * input.transpose();
    let eigen = gram.symmetric_eigen();
    let largest = eigen.eigenvalues.amax();
    let small = |k: &usize| eigen.eigenvalues[*k] <= RANK_TOLERANCE * largest;
    let columns: Vec<usize> = (0..input.nrows()).filter(small).collect();
    eigen.eigenvectors.select_columns(columns.iter())
}

/// A feedback with what proves it, in the file's units.
#[derive(Debug, Clone, PartialEq)]
pub struct StateFeedback {
    /// F, m x n.
    pub gain: DMatrix<f64>,
    /// P, n x n, symmetric.
    pub lyapunov: DMatrix<f64>,
    /// The number that the problem guarantees; see [`DesignProblem::GUARANTEE`].
    pub guarantee: f64,
    /// The auxiliary gains by name, m x n each.
    pub auxiliary: BTreeMap<String, DMatrix<f64>>,
}

/// The numbers of a proof over a [`Scalar`]: intervals for the check, exact rationals in tests.
#[derive(Debug, Clone)]
pub struct Proof<S> {
    /// A_i.
    pub vertices: Vec<Matrix<S>>,
    /// B.
    pub input: Matrix<S>,
    /// F.
    pub gain: Matrix<S>,
    /// P.
    pub lyapunov: Matrix<S>,
    /// The guaranteed number.
    pub guarantee: S,
    /// The auxiliary gains, in the order of [`DesignProblem::AUXILIARY_GAINS`].
    pub auxiliary: Vec<Matrix<S>>,
}

impl<S: Scalar> Proof<S> {
    /// The doubles of a plant and of a feedback, without rounding.
    pub fn new(plant: &VertexPlant, found: &StateFeedback) -> Self {
        Proof {
            vertices: plant.vertices.iter().map(Matrix::exactly).collect(),
            input: Matrix::exactly(&plant.input),
            gain: Matrix::exactly(&found.gain),
            lyapunov: Matrix::exactly(&found.lyapunov),
            guarantee: S::from_f64(found.guarantee),
            auxiliary: found.auxiliary.values().map(Matrix::exactly).collect(),
        }
    }

    /// `-(A'P + PA + 2 alpha P)` for `A = A_i + B F` with any gain F.
    pub fn decay(&self, vertex: &Matrix<S>, gain: &Matrix<S>, rate: &S) -> Matrix<S> {
        let closed = vertex.plus(&self.input.times(gain));
        let derivative = self.lyapunov.times(&closed).symmetrised();
        let twice = rate.clone() + rate.clone();
        derivative.plus(&self.lyapunov.scaled(&twice)).negated()
    }

    /// `[ P, h' ; h, b^2 ]`, positive definite when |h x| < b wherever x'Px <= 1.
    pub fn within(&self, row: &Matrix<S>, bound: f64) -> Matrix<S> {
        let bound = S::from_f64(bound);
        let corner = Matrix::identity(1, bound.clone() * bound);
        Matrix::symmetric(&[&[&self.lyapunov, &row.transposed()], &[&corner]])
    }
}
