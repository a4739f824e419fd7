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

use crate::model::Imperfections;
use verified::matrix::Matrix;
use verified::scalar::Scalar;

/// The set of the actuators' gain matrices.
pub(super) struct GainError<S> {
    /// G, m x m, diagonal.
    pub centre: Matrix<S>,
    /// The uncertain entries (i, j), each with its half-width a_k.
    pub entries: Vec<((usize, usize), S)>,
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
