//! Sets that the certified set must contain, linearised about a known point.

use nalgebra::DMatrix;

use super::unknowns::DesignUnknowns;
use crate::conditions::Task;
use sdp::lmi::{Affine, Condition};

/// `Qh'P + P'Qh - P'Uh P >= s^2 D D'` with s = 1 for what is contained and `scale_squared` for what is scaled.
///
/// It implies U^-1 = Qh' Uh^-1 Qh >= s^2 D D', because (Qh - Uh P)' Uh^-1 (Qh - Uh P) >= 0; that is
/// s^2 D'UD <= I. For P = rho I it is the condition in `start.rs`.
pub fn containment(
    task: &Task,
    unknowns: &DesignUnknowns,
    scale_squared: &Affine,
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
    let contained = contained.map(|(k, d)| stated(format!("covered set {}", k + 1), d, &one));
    let scaled = containment.scaled.iter().enumerate();
    let scaled = scaled.map(|(k, d)| stated(format!("grown set {}", k + 1), d, scale_squared));
    contained.chain(scaled).collect()
}
