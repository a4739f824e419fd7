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
    let decay = task.specification.decay_rate * &unknowns.lyapunov;
    let output_unit = task.gain_unit().sqrt();
    let seen = &unknowns.multiplier * &(output.transpose() / output_unit);
    let identity = DMatrix::identity(outputs, outputs) / task.gain_unit();
    let gamma = unknowns.gain_bound.times_matrix(&identity);
    let lhs = SymmetricBlocks::of(&[&[&decay, &seen], &[&gamma]]);
    strictness.positive("peak gain", lhs)
}

/// The name and the weight of every bounded signal; of the disturbance the whole supply relative to it: with a measurement
/// error and the trigger's floor that of all three.
fn weights(task: &Task, unknowns: &DesignUnknowns) -> Vec<(&'static str, Affine)> {
    let floor = task.imperfections.floor;
    let mut supply = unknowns.disturbance_weight.clone();
    if let Some(own) = &unknowns.measurement {
        supply += &own.supply;
    }
    let supply = (1.0 + floor.share) * supply + Affine::identity(1, floor.constant);
    let names = task.further_signals.iter().map(|signal| signal.name);
    let further = names.zip(unknowns.further_weights.iter().cloned());
    std::iter::once(("disturbance", supply))
        .chain(further)
        .collect()
}

/// How the names of the conditions gamma >= w xi begin.
pub const GAIN_ABOVE: &str = "gain bound above";

/// gamma >= xi (in the units of xi), or a multiple of xi: see [`Task::gain_per_weight`].
pub(super) fn gain_above_weight<'a>(
    task: &'a Task,
    unknowns: &'a DesignUnknowns,
    strictness: &'a Strictness,
) -> impl Iterator<Item = Condition> + 'a {
    weights(task, unknowns).into_iter().map(|(name, weight)| {
        strictness.positive(
            format!("{GAIN_ABOVE} {name} weight"),
            1.0 / task.gain_unit() * &unknowns.gain_bound - weight,
        )
    })
}

/// xi <= xi_max, which [`Task::invariant_level`] relies on.
pub(super) fn weight_bound<'a>(
    task: &'a Task,
    unknowns: &'a DesignUnknowns,
) -> impl Iterator<Item = Condition> + 'a {
    let largest = Affine::identity(1, task.specification.disturbance_weight_max);
    weights(task, unknowns)
        .into_iter()
        .map(move |(name, weight)| {
            Condition::semidefinite(format!("{name} weight bound"), &largest - &weight)
        })
}
