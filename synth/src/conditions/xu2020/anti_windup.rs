//! Condition (19): inside the invariant set the sector bound of the dead zone holds.

use super::{DesignUnknowns, Strictness};
use crate::conditions::Task;
use crate::lmi::{Condition, SymmetricBlocks};

/// `[ ubar_s^2/k2 Uh, (Fh - Nh)_s' ; *, 1 ] >= 0` for every input s.
pub(super) fn anti_windup<'a>(
    task: &'a Task,
    unknowns: &'a DesignUnknowns,
    strictness: &'a Strictness,
) -> impl Iterator<Item = Condition> + 'a {
    let level = task.invariant_level();
    let limits = task.system.input_limit.iter().enumerate();
    limits.map(move |(input, limit)| {
        let difference = match &unknowns.sector {
            Some(sector) => &unknowns.gain - &sector.anti_windup,
            None => unknowns.gain.clone(),
        };
        let mut lhs = SymmetricBlocks::new(&[task.system.states(), 1]);
        lhs.add(0, 0, &(limit * limit / level * &unknowns.lyapunov));
        lhs.add(0, 1, &difference.row(input).transposed());
        lhs.add(1, 1, &crate::lmi::Affine::identity(1, 1.0));
        strictness.positive(format!("anti-windup input {}", input + 1), lhs.finish())
    })
}

/// S > 0, entry by entry.
pub(super) fn sector_positive<'a>(
    unknowns: &'a DesignUnknowns,
    strictness: &'a Strictness,
) -> impl Iterator<Item = Condition> + 'a {
    unknowns.sector.iter().flat_map(move |sector| {
        let weight = sector.weight_in_row_units();
        (0..weight.nrows()).map(move |input| {
            let entry = weight.view(input, input, 1, 1);
            strictness.positive(format!("sector weight input {}", input + 1), entry)
        })
    })
}
