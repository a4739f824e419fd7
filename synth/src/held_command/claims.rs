//! What a certificate claims: the largest numbers that its U and its supply allow, a little rounded to the safe side.

use nalgebra::DMatrix;

use crate::certify::held_command::{reached_from_rest, HeldCommandCertificate, Stage};
use crate::certify::FinalBounds;

/// Relative allowance of a claim, so that the check can prove it.
const ALLOWANCE: f64 = 1e-5;

/// Relative distance of the hand-over level from the largest one.
const ROOM: f64 = 1e-3;

fn largest(matrix: DMatrix<f64>) -> f64 {
    matrix.symmetric_eigenvalues().max()
}

/// Fills in the claims of the certificate of a stage; `None` where U is singular.
pub(super) fn claimed(stage: &Stage) -> Option<HeldCommandCertificate> {
    let mut out = stage.certificate.clone();
    let attitude = out.lyapunov.view((3, 3), (3, 3)).into_owned();
    out.certified_vector_part = ((1.0 - ALLOWANCE) / largest(attitude)).sqrt();
    let inverse = out.lyapunov.clone().try_inverse()?;
    let reached = reached_from_rest(stage);
    let bound = |first: usize| {
        let part = inverse.view((first, first), (3, 3)).into_owned();
        (reached * largest(part) * (1.0 + ALLOWANCE)).sqrt()
    };
    out.final_bounds = FinalBounds {
        rate: bound(0),
        vector_part: bound(3),
    };
    let claims = [
        out.certified_vector_part,
        out.final_bounds.rate,
        out.final_bounds.vector_part,
    ];
    claims.iter().all(|claim| claim.is_finite()).then_some(out)
}

/// The largest level that the last set contains and at which every command is legal there, a little rounded to the safe
/// side; the state falls to a larger level earlier. `None` where U is not positive definite.
pub(super) fn largest_hand_over(start: &Stage, last: &Stage) -> Option<f64> {
    let factor = start.certificate.lyapunov.clone().cholesky()?;
    let inverse = factor.inverse();
    let triangle = factor.l().try_inverse()?;
    let contained = 1.0 / largest(&triangle * &last.certificate.lyapunov * triangle.transpose());
    let law = start.law;
    let limit = last.model.plant.takagi_sugeno().input_limit.min();
    let room = limit / last.certificate.within_limit - law.trigger.absolute_nm;
    let bound = room / (1.0 + law.trigger.relative);
    let held = bound * bound / largest(&law.gain * inverse * law.gain.transpose());
    let level = contained.min(held).min(1.0) * (1.0 - ROOM);
    (level.is_finite() && room > 0.0).then_some(level)
}
