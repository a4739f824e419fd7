//! The actuators' gain error in the form of (18): see [`GainError`](super::gain_error::GainError).

use super::Assembly;
use crate::certify::signals::{ProofSignal, SignalForm};
use verified::matrix::Matrix;
use verified::scalar::Scalar;

use ProofSignal::{DeadZone, Error, Sample};

impl<S: Scalar> Assembly<'_, S> {
    /// Adds the bound above to the form of (18), for u = F w with w = x(t_k^l) - e.
    pub(super) fn add_gain_error(&self, form: &mut SignalForm<S>, gain: &Matrix<S>) {
        let Some(error) = &self.gain_error else {
            return;
        };
        let input = &self.plant.input;
        let (n, rows) = (input.nrows(), error.rows());
        let own = ProofSignal::GainError;
        let columns = Matrix::from_fn(n, rows, |r, k| {
            let ((i, _), width) = &error.entries[k];
            input.at(r, *i).clone() * width.clone()
        });
        self.multiplied(form, own, &columns);
        let weights = &self.certificate.gain_error_weight;
        let weight = |k: usize| S::from_f64(weights.get(k).copied().unwrap_or(0.0));
        let squares = Matrix::from_fn(rows, rows, |r, c| match r == c {
            true => -weight(r),
            false => S::zero(),
        });
        form.add(own, own, &squares);
        let m = gain.nrows();
        let mut sums = vec![S::zero(); m];
        for (k, ((_, j), _)) in error.entries.iter().enumerate() {
            sums[*j] = sums[*j].clone() + weight(k);
        }
        // T (F w - p)^2
        let total = Matrix::from_fn(m, m, |r, c| match r == c {
            true => sums[r].clone(),
            false => S::zero(),
        });
        let seen = gain.transposed().times(&total);
        let square = seen.times(gain);
        form.add(Sample, Sample, &square);
        form.add(Sample, Error, &square.negated());
        form.add(Error, Error, &square);
        form.add(Sample, DeadZone, &seen.negated());
        form.add(Error, DeadZone, &seen);
        form.add(DeadZone, DeadZone, &total);
    }
}
