//! Condition (20): the L-infinity gain.

use nalgebra::DMatrix;

use super::{DesignUnknowns, Strictness};
use crate::conditions::Task;
use crate::lmi::{Affine, Condition, SymmetricBlocks};

/// `[ phi Uh, Qh C' ; *, gamma I ] > 0`: y'y <= gamma phi x'Ux.
pub(super) fn peak_gain(
    task: &Task,
    unknowns: &DesignUnknowns,
    strictness: &Strictness,
) -> Condition {
    let output = &task.system.output;
    let outputs = output.nrows();
    let mut lhs = SymmetricBlocks::new(&[task.system.states(), outputs]);
    lhs.add(0, 0, &(task.specification.decay_rate * &unknowns.lyapunov));
    lhs.add(0, 1, &(&unknowns.multiplier * &output.transpose()));
    let identity = DMatrix::identity(outputs, outputs);
    lhs.add(1, 1, &unknowns.gain_bound.times_matrix(&identity));
    strictness.positive("peak gain", lhs.finish())
}

/// gamma >= xi (in SI units) and xi <= xi_max (which [`Task::invariant_level`] relies on).
pub(super) fn weight_bounds(
    task: &Task,
    unknowns: &DesignUnknowns,
    strictness: &Strictness,
) -> [Condition; 2] {
    let weight = &unknowns.disturbance_weight;
    let largest = Affine::identity(1, task.specification.disturbance_weight_max);
    [
        strictness.positive(
            "gain bound above disturbance weight",
            &unknowns.gain_bound - &(task.disturbance_weight_unit * weight),
        ),
        Condition::semidefinite("disturbance weight bound", &largest - weight),
    ]
}
