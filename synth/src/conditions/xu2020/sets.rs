//! The certified set: it lies in the region where the model holds, and holds what it must contain.

use nalgebra::DMatrix;

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

/// `rho (Qh + Qh') - rho^2 Uh >= x0 x0'`, which implies x0' U x0 <= 1 for any rho > 0 because
/// Qh' Uh^-1 Qh >= rho (Qh + Qh') - rho^2 Uh.
pub(super) fn must_contain<'a>(
    task: &'a Task,
    unknowns: &'a DesignUnknowns,
    strictness: &'a Strictness,
) -> impl Iterator<Item = Condition> + 'a {
    let rho = task.specification.containment_weight;
    let states = task.specification.must_contain.iter().enumerate();
    states.map(move |(index, state)| {
        let inner = rho * unknowns.multiplier.symmetrised() - rho * rho * &unknowns.lyapunov;
        let outer = Affine::constant(&(state * state.transpose()));
        strictness.positive(format!("must contain state {}", index + 1), inner - outer)
    })
}

/// Sets that must be contained, linearised about a known point P:
/// `Qh'P + P'Qh - P'Uh P >= s^2 D D'` with s = 1 for what is contained and `scale_squared` for what is scaled.
///
/// It implies U^-1 = Qh' Uh^-1 Qh >= s^2 D D', because (Qh - Uh P)' Uh^-1 (Qh - Uh P) >= 0; that is
/// s^2 D'UD <= I. For P = rho I it is the condition of `must_contain`.
pub fn containment(
    task: &Task,
    unknowns: &DesignUnknowns,
    scale_squared: &Affine,
    strictness: &Strictness,
) -> Vec<Condition> {
    let Some(containment) = &task.containment else {
        return Vec::new();
    };
    let p = &containment.linearisation;
    let linear = (&unknowns.multiplier.transposed() * p).symmetrised();
    let inner = linear - unknowns.lyapunov.congruence(p);
    let one = Affine::identity(1, 1.0);
    let stated = |name: String, direction: &DMatrix<f64>, squared: &Affine| {
        let outer = squared.times_matrix(&(direction * direction.transpose()));
        Condition::semidefinite(name, &inner - &outer)
    };
    let contained = containment.contained.iter().enumerate();
    // With a margin: what a nearly singular Qh makes of a solver's tolerance may be large.
    let contained = contained.map(|(k, d)| {
        let outer = one.times_matrix(&(d * d.transpose()));
        strictness.positive(format!("covered set {}", k + 1), &inner - &outer)
    });
    let scaled = containment.scaled.iter().enumerate();
    let scaled = scaled.map(|(k, d)| stated(format!("grown set {}", k + 1), d, scale_squared));
    contained.chain(scaled).collect()
}
