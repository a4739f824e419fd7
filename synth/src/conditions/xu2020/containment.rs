//! Sets that the certified set must contain, linearised about a known point.

use nalgebra::DMatrix;

use super::DesignUnknowns;
use crate::conditions::Task;
use crate::lmi::{Affine, Condition};

/// What x'Ux <= 1 must cover: ellipsoids {D z, |z| <= 1}, a single column being a state and its negative.
/// n states.
#[derive(Debug, Clone, PartialEq)]
pub struct Coverage {
    /// P, n x n, in the units of the task. Near P = Uh^-1 Qh of the sought point nothing is lost.
    pub linearisation: DMatrix<f64>,
    /// The D, n x k each, to be covered as they are.
    pub covered: Vec<DMatrix<f64>>,
    /// The D to be covered after multiplication by one common scale, which may be maximised.
    pub grown: Vec<DMatrix<f64>>,
}

impl Coverage {
    /// The scalar case P = rho I, which needs no known point.
    pub fn scalar(states: usize, rho: f64) -> Self {
        Coverage {
            linearisation: DMatrix::identity(states, states) * rho,
            covered: Vec::new(),
            grown: Vec::new(),
        }
    }
}

/// `Qh'P + P'Qh - P'Uh P >= s^2 D D'` with s = 1 for what is covered and `scale_squared` for what is grown.
///
/// It implies U^-1 = Qh' Uh^-1 Qh >= s^2 D D', because (Qh - Uh P)' Uh^-1 (Qh - Uh P) >= 0; that is
/// s^2 D'UD <= I. For P = rho I it is the condition in `start.rs`.
pub fn coverage(task: &Task, unknowns: &DesignUnknowns, scale_squared: &Affine) -> Vec<Condition> {
    let Some(coverage) = &task.coverage else {
        return Vec::new();
    };
    let p = &coverage.linearisation;
    let linear = (&unknowns.multiplier.transposed() * p).symmetrised();
    let inner = linear - unknowns.lyapunov.congruence(p);
    let one = Affine::identity(1, 1.0);
    let stated = |name: String, direction: &DMatrix<f64>, squared: &Affine| {
        let outer = squared.times_matrix(&(direction * direction.transpose()));
        Condition::semidefinite(name, &inner - &outer)
    };
    let covered = coverage.covered.iter().enumerate();
    let covered = covered.map(|(k, d)| stated(format!("covered set {}", k + 1), d, &one));
    let grown = coverage.grown.iter().enumerate();
    let grown = grown.map(|(k, d)| stated(format!("grown set {}", k + 1), d, scale_squared));
    covered.chain(grown).collect()
}
