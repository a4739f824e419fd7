//! The invariant set lies inside the region in which the model holds.

use super::unknowns::DesignUnknowns;
use crate::conditions::Task;
use sdp::lmi::{Affine, Condition, Strictness, SymmetricBlocks};

/// `[ b^2/k2 Uh, Qh H' ; *, I ] >= 0`: |H x| <= b wherever x'Ux <= k2.
pub(super) fn region<'a>(
    task: &'a Task,
    unknowns: &'a DesignUnknowns,
    strictness: &'a Strictness,
) -> impl Iterator<Item = Condition> + 'a {
    let level = task.invariant_level();
    task.system.region.iter().map(move |bound| {
        let rows = bound.rows.nrows();
        let scaled = bound.bound_squared / level * &unknowns.lyapunov;
        let beside = &unknowns.multiplier * &bound.rows.transpose();
        let lhs = SymmetricBlocks::of(&[&[&scaled, &beside], &[&Affine::identity(rows, 1.0)]]);
        strictness.positive(format!("box {}", bound.name), lhs)
    })
}
