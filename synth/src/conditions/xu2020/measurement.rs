//! Conditions (A) on the weights of a measurement error, transformed.
//!
//! The trigger sees x(t_k^l) + d. Its inequality then bounds the error ee = x(t_k^l) - w through Wp instead of W, where
//! `[ W - Wp, W ; W, W + Lam ] >= 0`, and adds d'Lam d <= s to the supply. After the congruence with Qh the last block is
//! `Wh + Qh Lam Qh'`, which for any R is at least `Wh + R Qh' + Qh R' - R Lam^-1 R'`, and equal to it at R = Qh Lam.

use nalgebra::DMatrix;

use super::unknowns::{DesignUnknowns, MeasurementUnknowns};
use crate::conditions::{MeasurementError, MeasurementPoint, Task};
use sdp::lmi::{Affine, Condition, Strictness, SymmetricBlocks};

/// (A), and s / taubar^2 >= sum 1 / lambda; nothing for a perfect measurement.
pub(super) fn measurement(
    task: &Task,
    unknowns: &DesignUnknowns,
    strictness: &Strictness,
) -> Vec<Condition> {
    let (Some(error), Some(own)) = (&task.imperfections.measurement, &unknowns.measurement) else {
        return Vec::new();
    };
    let mut out = vec![strictness.positive("measurement supply", supply(own))];
    if let Some(point) = &error.point {
        let weights = weights(error, point, unknowns, own);
        out.push(Condition::semidefinite("measurement weight", weights));
    }
    out
}

/// `[ s / taubar^2, 1' ; 1, diag(lambda) ]`.
fn supply(own: &MeasurementUnknowns) -> Affine {
    let count = own.shares.len();
    let mut blocks = SymmetricBlocks::new(&vec![1; count + 1]);
    blocks.add(0, 0, &own.supply);
    for (index, share) in own.shares.iter().enumerate() {
        blocks.add(0, index + 1, &Affine::identity(1, 1.0));
        blocks.add(index + 1, index + 1, share);
    }
    blocks.finish()
}

/// `[ Wh - Wph, Wh C' ; *, C (Wh + P Qd' + Qd P' - P diag(lambda) P') C' ]` with Qd = Qh Delta^-1 and P = Qd diag(lambda)^-1 at
/// the point, C the inverse of the Cholesky factor of P Qd' there.
fn weights(
    error: &MeasurementError,
    point: &MeasurementPoint,
    unknowns: &DesignUnknowns,
    own: &MeasurementUnknowns,
) -> Affine {
    let inverse_sizes = DMatrix::from_diagonal(&error.sizes.map(|size| 1.0 / size));
    let known = &point.multiplier * &inverse_sizes;
    let inverse_shares = error.balls.iter().map(|&ball| 1.0 / point.shares[ball]);
    let inverse_shares = nalgebra::DVector::from_iterator(error.balls.len(), inverse_shares);
    let p = &known * DMatrix::from_diagonal(&inverse_shares);
    let c = unit_factor(&p, &known);
    let weight = &unknowns.trigger_weight;
    let scaled_p = &c * &p;
    let linear =
        &scaled_p * &(&(&inverse_sizes * &unknowns.multiplier.transposed()) * &c.transpose());
    let mut corner = weight.congruence(&c.transpose()) + linear.symmetrised();
    for (ball, share) in own.shares.iter().enumerate() {
        let of_ball = error
            .balls
            .iter()
            .map(|&own| f64::from(u8::from(own == ball)));
        let of_ball = nalgebra::DVector::from_iterator(error.balls.len(), of_ball);
        let square = &scaled_p * DMatrix::from_diagonal(&of_ball) * scaled_p.transpose();
        corner += &(-share.times_matrix(&square));
    }
    let upper = weight - &own.error_weight;
    SymmetricBlocks::of(&[&[&upper, &(weight * &c.transpose())], &[&corner]])
}

/// The inverse of the Cholesky factor of `P Qd'`, which brings the last row to size 1; the identity where it has none.
fn unit_factor(p: &DMatrix<f64>, known: &DMatrix<f64>) -> DMatrix<f64> {
    let side = p.nrows();
    let whole = p * known.transpose();
    let factor = (0.5 * (&whole + whole.transpose())).cholesky();
    let inverse = factor.and_then(|factor| factor.l().try_inverse());
    inverse.unwrap_or_else(|| DMatrix::identity(side, side))
}
