//! The signals of condition (18), and the bounded ones among them, as the proof has them.
//!
//! This list is the proof's own; synthesis has another one. Rows, blocks and names of the proof's matrices are read off
//! it. A further bounded signal is an entry of [`bounded`] and a number in the [`Certificate`].

use super::certificate::Certificate;
use super::plant::DescriptorPlant;
use crate::model::Model;
use verified::matrix::Matrix;
use verified::scalar::Scalar;

/// A quantity of which (18) is a quadratic form.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProofSignal {
    /// x(t).
    State,
    /// x'(t).
    Rate,
    /// The last sample x(t_k^l).
    Sample,
    /// The trigger error e = x(t_k^l) - x(t_k).
    Error,
    /// The dead zone p of the command.
    DeadZone,
    /// The actuators' gain errors z, one row for each uncertain entry.
    GainError,
    /// A signal of bounded norm, by its index in [`bounded`].
    Bounded(usize),
    /// The coordinate s of the integral's Schur complement; for r = 2 only.
    Integral,
}

/// A signal s of bounded norm: `E x' = ... + coefficient s` with `|s| <= bound`, and
/// `V' <= -phi V + weight |s|^2 + ...`.
#[derive(Debug, Clone)]
pub struct BoundedSignal<S> {
    /// The word for it in the names of conditions.
    pub name: &'static str,
    /// n x d: where it stands in the plant's equation.
    pub coefficient: Matrix<S>,
    /// Bound on its norm.
    pub bound: S,
    /// Its weight in a certificate, such as xi.
    pub weight: fn(&Certificate) -> f64,
}

/// The bounded signals of a model.
pub fn bounded<S: Scalar>(model: &Model) -> Vec<BoundedSignal<S>> {
    let plant = DescriptorPlant::new(&model.plant);
    vec![BoundedSignal {
        name: "disturbance",
        coefficient: plant.disturbance,
        bound: plant.disturbance_bound,
        weight: |certificate| certificate.disturbance_weight,
    }]
}

/// `sum weight bound^2`: the most that the signals feed.
pub fn fed<S: Scalar>(signals: &[BoundedSignal<S>], weight: impl Fn(&BoundedSignal<S>) -> S) -> S {
    signals.iter().fold(S::zero(), |sum, signal| {
        sum + weight(signal) * signal.bound.clone() * signal.bound.clone()
    })
}

/// `sum weight bound^2 / phi`: x'Ux never exceeds this, or 1, once it started below 1 and nothing else feeds it.
pub fn reached_level<S: Scalar>(
    signals: &[BoundedSignal<S>],
    weight: impl Fn(&BoundedSignal<S>) -> S,
    phi: &S,
) -> S {
    fed(signals, weight) / phi.clone()
}

/// A symmetric matrix with one block of rows for each of some signals.
#[derive(Debug, Clone)]
pub struct SignalForm<S> {
    /// The signals, each with its first row.
    places: Vec<(ProofSignal, usize)>,
    matrix: Matrix<S>,
}

impl<S: Scalar> SignalForm<S> {
    /// Zeros, for signals of the given sizes.
    pub fn zeros(signals: &[(ProofSignal, usize)]) -> Self {
        let mut side = 0;
        let places = signals.iter().map(|&(signal, size)| {
            side += size;
            (signal, side - size)
        });
        SignalForm {
            places: places.collect(),
            matrix: Matrix::zeros(side, side),
        }
    }

    /// Number of rows.
    pub fn side(&self) -> usize {
        self.matrix.nrows()
    }

    /// The first row of a signal.
    ///
    /// # Panics
    /// When the form does not have it.
    pub fn place(&self, signal: ProofSignal) -> usize {
        let mut places = self.places.iter();
        let found = places.find(|(own, _)| *own == signal);
        found.expect("a signal of the form").1
    }

    /// Adds `left' block right` and its transpose; for one signal `left' block left` with a symmetric block, whose part
    /// above the diagonal is read.
    pub fn add(&mut self, left: ProofSignal, right: ProofSignal, block: &Matrix<S>) {
        let (row, column) = (self.place(left), self.place(right));
        if row > column {
            return self.add(right, left, &block.transposed());
        }
        for r in 0..block.nrows() {
            for c in 0..block.ncols() {
                let (r0, c0) = (row + r, column + c);
                if r0 <= c0 {
                    let sum = self.matrix.at(r0, c0).clone() + block.at(r, c).clone();
                    self.matrix.set(c0, r0, sum.clone());
                    self.matrix.set(r0, c0, sum);
                }
            }
        }
    }

    /// Adds a symmetric matrix on all rows.
    pub fn add_whole(&mut self, matrix: &Matrix<S>) {
        self.matrix = self.matrix.plus(matrix);
    }

    /// The negative of the matrix.
    pub fn negated(&self) -> Matrix<S> {
        self.matrix.negated()
    }
}
