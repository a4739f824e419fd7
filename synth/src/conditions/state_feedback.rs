//! Design problems for a constant state feedback: what they have in common.
//!
//! The plant is `x' = A(t) x + B u` with A(t) anywhere in the convex hull of its vertices, the feedback
//! `u = F x`, the proof a quadratic function x'Px. A [`DesignProblem`] adds the rest: its inequalities
//! in the transformed unknowns Q = P^-1 and Y = F Q, in which they are linear; the number that it
//! guarantees; and the same inequalities in P and F, which are checked without any solver.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use sdp::lmi::{Affine, Condition, Strictness, Unknowns};
use verified::matrix::Matrix;
use verified::scalar::Scalar;

/// A problem for a [`VertexPlant`].
pub trait DesignProblem: Sized {
    /// The problem's key in a file, such as `h_infinity`.
    const NAME: &'static str;

    /// What the guaranteed number is.
    const GUARANTEE: &'static str;

    /// True when a larger guaranteed number is the better one.
    const LARGER_IS_BETTER: bool = false;

    /// Names of further m x n gains that the proof needs, in alphabetical order. Synthesis has them as
    /// Z = H Q.
    const AUXILIARY_GAINS: &'static [&'static str] = &[];

    /// Units in which the problem's numbers are about 1.
    fn units(&self, plant: &VertexPlant) -> Units;

    /// The problem in other units.
    fn in_units(&self, units: &Units) -> Self;

    /// alpha [1/s], 0 or above: whatever else is asked for, at every vertex
    /// `A_i Q + Q A_i' + B Y + Y'B' + 2 alpha Q < 0` follows from the conditions.
    fn decay_rate(&self) -> f64;

    /// The conditions on the transformed unknowns, as published.
    fn conditions(
        &self,
        plant: &VertexPlant,
        transformed: &Transformed,
        strictness: &Strictness,
    ) -> Vec<Condition>;

    /// Sets the number that a feedback guarantees, and the scale of P where the problem leaves it
    /// free. `objective` is what the solver reached, in `units`; the feedback and the problem are in
    /// the file's units.
    fn claim(&self, found: &mut StateFeedback, objective: f64, units: &Units);

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

/// `x' = A(t) x + B u` with A(t) in the convex hull of the vertices. n states, m inputs.
#[derive(Debug, Clone, PartialEq)]
pub struct VertexPlant {
    /// A_i, n x n.
    pub vertices: Vec<DMatrix<f64>>,
    /// B, n x m.
    pub input: DMatrix<f64>,
    /// A given feedback F, m x n, to be analysed; without it one is designed.
    pub gain: Option<DMatrix<f64>>,
}

/// Units of a scaled problem; every one is a power of two, so that they undo exactly.
#[derive(Debug, Clone, PartialEq)]
pub struct Units {
    /// Unit of time (s).
    pub time: f64,
    /// Unit of every state.
    pub state: f64,
    /// Unit of each input.
    pub input: DVector<f64>,
    /// Unit of the disturbance.
    pub disturbance: f64,
    /// Unit of the output.
    pub output: f64,
}

/// The power of two nearest to a positive number in ratio; 1 for anything else.
pub fn power_of_two(value: f64) -> f64 {
    match value.is_finite() && value > 0.0 {
        true => value.log2().round().clamp(-500.0, 500.0).exp2(),
        false => 1.0,
    }
}

impl Units {
    /// The unit of time makes the largest vertex about 1, those of the inputs the columns of B.
    pub fn of(plant: &VertexPlant, state: f64) -> Self {
        let largest = plant.vertices.iter().map(DMatrix::norm).fold(0.0, f64::max);
        let time = power_of_two(1.0 / largest);
        let columns = plant.input.column_iter();
        let inputs = columns.map(|column| power_of_two(state / (time * column.norm())));
        Units {
            time,
            state,
            input: DVector::from_iterator(plant.input.ncols(), inputs),
            disturbance: 1.0,
            output: 1.0,
        }
    }
}

impl VertexPlant {
    /// The plant in other units.
    pub fn in_units(&self, units: &Units) -> Self {
        let inputs = DMatrix::from_diagonal(&units.input);
        let inverse = DMatrix::from_diagonal(&units.input.map(|unit| 1.0 / unit));
        VertexPlant {
            vertices: self.vertices.iter().map(|a| units.time * a).collect(),
            input: &self.input * inputs * (units.time / units.state),
            gain: self.gain.as_ref().map(|gain| inverse * gain * units.state),
        }
    }

    /// Number of states n.
    pub fn states(&self) -> usize {
        self.input.nrows()
    }

    /// Number of inputs m.
    pub fn inputs(&self) -> usize {
        self.input.ncols()
    }
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
}

impl Transformed {
    /// The unknowns of a problem.
    pub fn new<P: DesignProblem>(unknowns: &mut Unknowns, plant: &VertexPlant) -> Self {
        let (n, m) = (plant.states(), plant.inputs());
        let inverse = unknowns.symmetric("Q", n);
        let gain = match &plant.gain {
            Some(given) => given * &inverse,
            None => unknowns.general("Y", m, n),
        };
        let auxiliary = P::AUXILIARY_GAINS.iter();
        Transformed {
            auxiliary: auxiliary
                .map(|name| unknowns.general(&format!("{name} Q"), m, n))
                .collect(),
            objective: unknowns.scalar("objective"),
            inverse,
            gain,
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
