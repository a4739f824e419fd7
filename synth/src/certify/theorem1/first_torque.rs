//! Before the first message arrives there is no torque.
//!
//! For at most d_m = N hbar + d_max the functional then obeys V' <= kappa V + xi |tau|^2, which holds when at every vertex, with
//! multipliers of its own,
//!
//! ```text
//! 2 (x'Q1 + x''Q2 + tau'Q3) (A x - E x' + B_w tau) + h_m x''Y x' + 2 x'U x' - kappa x'U x - xi |tau|^2 < 0.
//! ```

use nalgebra::DMatrix;

use super::{Assembly, FirstTorque};
use crate::certify::signals::{ProofSignal, SignalForm};
use verified::matrix::Matrix;
use verified::scalar::Scalar;

use ProofSignal::{Bounded, Rate, State};

impl<S: Scalar> Assembly<'_, S> {
    /// The conditions above, in a network with delay or loss.
    pub(super) fn first_torque(&self, emit: &mut impl FnMut(String, Matrix<S>)) {
        if !self.imperfections.is_networked() {
            return;
        }
        let Some(numbers) = &self.certificate.first_torque else {
            emit(
                "first torque numbers present".into(),
                Matrix::identity(1, -S::one()),
            );
            return;
        };
        let growth = S::from_f64(numbers.growth);
        emit(
            "growth before the first torque".into(),
            Matrix::identity(1, growth.clone()),
        );
        let start = self.supply.certified_start.clone();
        emit("certified starts".into(), Matrix::identity(1, start));
        let mut index = 0;
        for plant in &self.plants {
            for vertex in &plant.vertices {
                index += 1;
                let form = self.without_torque(numbers, &growth, (vertex, &plant.descriptor));
                emit(
                    format!("before the first torque vertex {index}"),
                    form.negated(),
                );
            }
        }
    }

    /// The form at one vertex.
    fn without_torque(
        &self,
        numbers: &FirstTorque,
        growth: &S,
        (vertex, descriptor): (&Matrix<S>, &Matrix<S>),
    ) -> SignalForm<S> {
        let exactly = |matrix: &DMatrix<f64>| Matrix::<S>::exactly(matrix);
        let n = self.plant.states();
        let bounded = self.bounded.iter().enumerate();
        let bounded = bounded.map(|(k, signal)| (Bounded(k), signal.coefficient.ncols()));
        let rows: Vec<(ProofSignal, usize)> =
            [(State, n), (Rate, n)].into_iter().chain(bounded).collect();
        let mut multipliers = vec![
            (State, exactly(&numbers.state)),
            (Rate, exactly(&numbers.rate)),
        ];
        let mut first = 0;
        for &(signal, size) in &rows[2..] {
            let block = numbers.disturbance.rows(first, size).into_owned();
            multipliers.push((signal, exactly(&block)));
            first += size;
        }
        let mut out = SignalForm::zeros(&rows);
        let mut multiply = |signal: ProofSignal, coefficient: &Matrix<S>| {
            for (row, multiplier) in &multipliers {
                let block = multiplier.times(coefficient);
                match *row == signal {
                    true => out.add(signal, signal, &block.symmetrised()),
                    false => out.add(*row, signal, &block),
                }
            }
        };
        multiply(State, vertex);
        multiply(Rate, &descriptor.negated());
        for (k, signal) in self.bounded.iter().enumerate() {
            multiply(Bounded(k), &signal.coefficient);
        }
        out.add(State, Rate, &self.lyapunov);
        out.add(State, State, &self.lyapunov.scaled(growth).negated());
        let integral = exactly(&self.certificate.integral_weight);
        out.add(Rate, Rate, &integral.scaled(&self.oldest));
        for (k, (signal, weight)) in self.weighted().enumerate() {
            let square = Matrix::identity(signal.coefficient.ncols(), -S::from_f64(weight));
            out.add(Bounded(k), Bounded(k), &square);
        }
        out
    }
}
