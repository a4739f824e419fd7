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
        let mut lhs = SymmetricBlocks::new(&[task.system.states(), rows]);
        lhs.add(0, 0, &(bound.bound_squared / level * &unknowns.lyapunov));
        lhs.add(0, 1, &(&unknowns.multiplier * &bound.rows.transpose()));
        lhs.add(1, 1, &Affine::identity(rows, 1.0));
        strictness.positive(format!("box {}", bound.name), lhs.finish())
    })
}
