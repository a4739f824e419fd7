//! Condition (20): the L-infinity gain.

use nalgebra::DMatrix;

use super::unknowns::DesignUnknowns;
use crate::conditions::Task;
use sdp::lmi::{Affine, Condition, Strictness, SymmetricBlocks};

/// `[ phi Uh, Qh C' ; *, gamma I ] > 0`: y'y <= gamma phi x'Ux. The second row is in units that make
/// gamma comparable with the scaled xi.
pub(super) fn peak_gain(
    task: &Task,
    unknowns: &DesignUnknowns,
    strictness: &Strictness,
) -> Condition {
    let output = &task.system.output;
    let outputs = output.nrows();
    let mut lhs = SymmetricBlocks::new(&[task.system.states(), outputs]);
    lhs.add(0, 0, &(task.specification.decay_rate * &unknowns.lyapunov));
    let output_unit = task.disturbance_weight_unit.sqrt();
    lhs.add(
        0,
        1,
        &(&unknowns.multiplier * &(output.transpose() / output_unit)),
    );
    let identity = DMatrix::identity(outputs, outputs) / task.disturbance_weight_unit;
    lhs.add(1, 1, &unknowns.gain_bound.times_matrix(&identity));
    strictness.positive("peak gain", lhs.finish())
}

/// gamma >= xi (in the units of xi).
pub(super) fn gain_above_weight(
    task: &Task,
    unknowns: &DesignUnknowns,
    strictness: &Strictness,
) -> Condition {
    let weight = &unknowns.disturbance_weight;
    strictness.positive(
        "gain bound above disturbance weight",
        1.0 / task.disturbance_weight_unit * &unknowns.gain_bound - weight.clone(),
    )
}

/// xi <= xi_max, which [`Task::invariant_level`] relies on.
pub(super) fn weight_bound(task: &Task, unknowns: &DesignUnknowns) -> Condition {
    let largest = Affine::identity(1, task.specification.disturbance_weight_max);
    Condition::semidefinite(
        "disturbance weight bound",
        &largest - &unknowns.disturbance_weight,
    )
}
