//! Actuators that apply (I + Delta(t)) sat(u) instead of sat(u).
//!
//! With I + Delta = G + sum_k a_k delta_k e_i e_j' over the uncertain entries k = (i, j), |delta_k| <= 1, and v'QB the row that
//! multiplies the torque,
//!
//! ```text
//! 2 v'QB (Delta + I - G) (F w - p) <= sum_k T_k (F w - p)_j^2 + a_k^2 (v'QB e_i)^2 / T_k
//! ```
//!
//! for every T_k > 0. The last term is the Schur complement of a row z_k with 2 v'QB e_i a_k z_k - T_k z_k^2.

use super::Assembly;
use crate::certify::signals::{ProofSignal, SignalForm};
use crate::model::Imperfections;
use verified::matrix::Matrix;
use verified::scalar::Scalar;

use ProofSignal::{DeadZone, Error, Sample};

/// The set of the actuators' gain matrices.
pub(super) struct GainError<S> {
    /// G, m x m, diagonal.
    pub centre: Matrix<S>,
    /// The uncertain entries (i, j), each with its half-width a_k.
    entries: Vec<((usize, usize), S)>,
}

impl<S: Scalar> GainError<S> {
    /// That of a model; `None` where the gain is 1.
    pub fn of(imperfections: &Imperfections, inputs: usize) -> Option<Self> {
        if !imperfections.changes_gain() {
            return None;
        }
        let half = || S::from_f64(0.5);
        let ends = |input: usize| imperfections.effectiveness_of(input).map(S::from_f64);
        let width = |(i, j): (usize, usize)| match i == j {
            true => {
                let [lowest, highest] = ends(i);
                (highest - lowest) * half()
            }
            false => S::from_f64(imperfections.misalignment),
        };
        let entries = imperfections.uncertain_gains(inputs).into_iter();
        Some(GainError {
            centre: Matrix::from_fn(inputs, inputs, |r, c| match r == c {
                true => {
                    let [lowest, highest] = ends(r);
                    (lowest + highest) * half()
                }
                false => S::zero(),
            }),
            entries: entries.map(|entry| (entry, width(entry))).collect(),
        })
    }

    /// Number of uncertain entries.
    pub fn rows(&self) -> usize {
        self.entries.len()
    }
}

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
