//! Start states that the certified set must contain.

use super::unknowns::DesignUnknowns;
use crate::conditions::Task;
use sdp::lmi::{Affine, Condition};

/// `rho (Qh + Qh') - rho^2 Uh >= x0 x0'`, which implies x0' U x0 <= 1 for any rho > 0 because
/// Qh' Uh^-1 Qh >= rho (Qh + Qh') - rho^2 Uh.
pub(super) fn must_contain<'a>(
    task: &'a Task,
    unknowns: &'a DesignUnknowns,
) -> impl Iterator<Item = Condition> + 'a {
    let rho = task.specification.containment_weight;
    let states = task.specification.must_contain.iter().enumerate();
    states.map(move |(index, state)| {
        let inner = rho * unknowns.multiplier.symmetrised() - rho * rho * &unknowns.lyapunov;
        let outer = Affine::constant(&(state * state.transpose()));
        Condition::semidefinite(format!("must contain state {}", index + 1), inner - outer)
    })
}
