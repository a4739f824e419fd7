//! Measurement errors d of the sample behind the torque in force: d'Lam d <= s.
//!
//! The trigger sees x(t_k^l) + d in the place of x(t_k^l): with ee = x(t_k^l) - w the inequality e'We <= nu w'Ww + eps_a gives
//! 0 <= nu w'Ww - ee' Wp ee + d'Lam d + eps_a for every Wp with
//!
//! ```text
//! [ W - Wp, W ; W, W + Lam ] > 0                                                               (A)
//! ```

use super::{supply, Assembly};
use crate::model::ErrorBall;
use verified::matrix::Matrix;
use verified::scalar::Scalar;

/// Relative distance from a norm to the double that bounds it.
const BEYOND: f64 = 1e-9;

impl<S: Scalar> Assembly<'_, S> {
    /// The sets of states whose measurement errors are bounded together; none for a perfect measurement.
    fn balls(&self) -> Vec<ErrorBall> {
        let bounds = self.imperfections.measurement_error();
        bounds.map_or(Vec::new(), |bounds| bounds.balls())
    }

    /// (A), and Lam > 0.
    pub(super) fn measurement(&self, emit: &mut impl FnMut(String, Matrix<S>)) {
        let needed = self.imperfections.measurement_error().is_some();
        let Some(weights) = &self.certificate.measurement else {
            if needed {
                emit(
                    "measurement weights present".into(),
                    Matrix::identity(1, -S::one()),
                );
            }
            return;
        };
        let weight = self.trigger_weight();
        let lambda = Matrix::from_fn(weight.nrows(), weight.nrows(), |r, c| match r == c {
            true => S::from_f64(weights.sample_weight[r]),
            false => S::zero(),
        });
        let upper = weight.minus(&Matrix::exactly(&weights.error_weight));
        let whole = Matrix::symmetric(&[&[&upper, &weight], &[&weight.plus(&lambda)]]);
        emit("measurement weight".into(), whole);
        for (state, &own) in weights.sample_weight.iter().enumerate() {
            let name = format!("measurement sample weight {}", state + 1);
            emit(name, Matrix::identity(1, S::from_f64(own)));
        }
    }

    /// What is left of an input's limit for the state itself: ubar_s less eta_s, the most that `row` makes of a measurement
    /// error. The norms in eta_s are doubles, which statements show to be large enough.
    pub(super) fn limit_without_error(
        &self,
        limit: &S,
        row: &Matrix<S>,
        name: &str,
        emit: &mut impl FnMut(String, Matrix<S>),
    ) -> S {
        let mut left = limit.clone();
        for (index, ball) in self.balls().iter().enumerate() {
            let entries = ball.states.iter().map(|&state| row.at(0, state));
            let squared = entries.fold(S::zero(), |sum, entry| sum + entry.clone() * entry.clone());
            let norm = above_root(&squared);
            let room = norm.clone() * norm.clone() - squared;
            emit(
                format!("{name} error {}", index + 1),
                Matrix::identity(1, room),
            );
            left = left - supply::radius::<S>(ball) * norm;
        }
        if !self.balls().is_empty() {
            let name = format!("{name} limit above its error");
            emit(name, Matrix::identity(1, left.clone()));
        }
        left
    }
}

/// A double a little above the square root.
fn above_root<S: Scalar>(square: &S) -> S {
    let root = square.approximate().max(0.0).sqrt();
    S::from_f64(root * (1.0 + BEYOND) + f64::MIN_POSITIVE.sqrt())
}
