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

/// The instants between samples that a condition is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Instant {
    /// Just after a sample (r = 1).
    Start,
    /// At the end of the longest interval (r = 2).
    End,
    /// Any, in a network with delay or loss, where the functional is that of the book's chapter on imperfections.
    Any,
}

impl Instant {
    /// The number r.
    pub fn index(self) -> usize {
        match self {
            Instant::Start => 1,
            Instant::End | Instant::Any => 2,
        }
    }

    /// What the names of its conditions begin with.
    pub fn label(self) -> &'static str {
        match self {
            Instant::Start => "decrease r=1",
            Instant::End => "decrease r=2",
            Instant::Any => "decrease",
        }
    }
}

/// The integral of the functional with the free matrices that bound it.
#[derive(Debug, Clone)]
pub struct IntegralTerm<S> {
    /// Y.
    pub weight: Matrix<S>,
    /// L1.
    pub free_state: Matrix<S>,
    /// L2.
    pub free_sample: Matrix<S>,
    /// The greatest age of the sample behind the torque in force.
    pub oldest: S,
    /// Not below e^(phi oldest).
    pub growth: S,
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

    /// Adds 2 (x'L1 + x(t_k)'L2) (x - x(t_k)), and what the integral gives at an instant.
    pub fn add_integral(&mut self, term: &IntegralTerm<S>, instant: Instant) {
        use ProofSignal::{Integral, Rate, Sample, State};
        let IntegralTerm {
            weight,
            free_state,
            free_sample,
            oldest,
            growth,
        } = term;
        self.add(State, State, &free_state.symmetrised());
        self.add(State, Sample, &free_state.negated());
        self.add(Sample, State, free_sample);
        self.add(Sample, Sample, &free_sample.symmetrised().negated());
        if instant != Instant::End {
            self.add(Rate, Rate, &weight.scaled(oldest));
        }
        if instant != Instant::Start {
            // [Xi, k L; k L', -k Y] with k = oldest e^(phi oldest) has the Schur complement Xi + k L Y^-1 L'.
            let factor = oldest.clone() * growth.clone();
            self.add(State, Integral, &free_state.scaled(&factor));
            self.add(Sample, Integral, &free_sample.scaled(&factor));
            self.add(Integral, Integral, &weight.scaled(&factor).negated());
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
