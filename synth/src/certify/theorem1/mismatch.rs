//! Gains scheduled by memberships that differ from the plant's by at most kappa.

use nalgebra::DMatrix;

use super::{Assembly, MismatchSlack};
use crate::certify::signals::{ProofSignal, SignalForm};
use verified::matrix::Matrix;
use verified::scalar::Scalar;

use ProofSignal::{DeadZone, Error, Rate, Sample, State};

impl<S: Scalar> Assembly<'_, S> {
    /// The slack for one end of the interval, where kappa is above 0 and the slack fits.
    fn slack(&self, interval: usize) -> Option<(&S, &MismatchSlack)> {
        let (kappa, slack) = (
            self.matched.as_ref()?,
            self.certificate.mismatch.get(interval - 1)?,
        );
        let side = self.certificate.mismatch_side();
        let fits = |matrix: &DMatrix<f64>| matrix.shape() == (side, side);
        let complete = slack.bounds.len() == self.gains.len();
        let fitting = slack.bounds.iter().all(fits) && fits(&slack.common);
        (complete && fitting).then_some((kappa, slack))
    }

    /// P_j > N_j - R and P_j > R - N_j with N_j the form of gain j. As sum_j delta_j = 0 for delta =
    /// zeta(t_k) - zeta(t), the gains add sum_j delta_j (N_j - R) <= kappa sum_j P_j.
    pub(super) fn mismatch(&self, emit: &mut impl FnMut(String, Matrix<S>)) {
        for interval in [1, 2] {
            let Some((_, slack)) = self.slack(interval) else {
                if self.slack_needed {
                    let name = format!("mismatch r={interval} slack present");
                    emit(name, Matrix::identity(1, -S::one()));
                }
                continue;
            };
            let common = Matrix::exactly(&slack.common);
            for (rule, (gains, bound)) in self.gains.iter().zip(&slack.bounds).enumerate() {
                let difference = self.gain_form(gains).minus(&common);
                let bound = Matrix::exactly(bound);
                let name = |side| format!("mismatch r={interval} gain {} {side}", rule + 1);
                emit(name("above"), bound.minus(&difference));
                emit(name("below"), bound.plus(&difference));
            }
        }
    }

    /// The form 2 (B'Q'v)' F_j x(t_k) + 2 (M p)' N_j x(t_k) as a matrix on the rows of
    /// [`MismatchSlack`].
    fn gain_form(&self, (gain, anti_windup): &(Matrix<S>, Matrix<S>)) -> Matrix<S> {
        let (m, n) = (gain.nrows(), gain.ncols());
        let zone = self.certificate.mismatch_side() - m - n;
        let zeros = |rows, columns| Matrix::zeros(rows, columns);
        let sector = match zone {
            0 => &zeros(0, n),
            _ => anti_windup,
        };
        Matrix::symmetric(&[
            &[&zeros(m, m), &zeros(m, zone), gain],
            &[&zeros(zone, zone), sector],
            &[&zeros(n, n)],
        ])
    }

    /// kappa sum_j P_j on the rows of (18).
    pub(super) fn mismatch_term(&self, interval: usize, form: &SignalForm<S>) -> Option<Matrix<S>> {
        let (kappa, slack) = self.slack(interval)?;
        let (n, m) = (self.plant.states(), self.plant.input.ncols());
        let side = self.certificate.mismatch_side();
        let zone = side - m - n;
        let mut seen = Matrix::zeros(side, form.side());
        let mut see = |row: usize, signal: ProofSignal, block: &Matrix<S>| {
            for r in 0..block.nrows() {
                for c in 0..block.ncols() {
                    seen.set(row + r, form.place(signal) + c, block.at(r, c).clone());
                }
            }
        };
        for (signal, multiplier) in [State, Rate, Sample].into_iter().zip(&self.multipliers) {
            let command = self.plant.input.transposed();
            see(0, signal, &command.times(&multiplier.transposed()));
        }
        let sector = DMatrix::from_diagonal(&self.certificate.sector_weight.rows(0, zone));
        see(m, DeadZone, &Matrix::exactly(&sector));
        see(m + zone, Sample, &Matrix::identity(n, S::one()));
        see(m + zone, Error, &Matrix::identity(n, -S::one()));
        let bounds = slack.bounds.iter();
        let sum = bounds.fold(Matrix::zeros(side, side), |sum, bound| {
            sum.plus(&Matrix::exactly(bound))
        });
        Some(seen.transposed().times(&sum.scaled(kappa)).times(&seen))
    }
}
