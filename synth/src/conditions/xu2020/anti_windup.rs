//! Condition (19): inside the invariant set the sector bound of the dead zone holds.

use super::unknowns::DesignUnknowns;
use crate::conditions::Task;
use sdp::lmi::{Affine, Condition, Strictness, SymmetricBlocks};

/// `[ ubar_s^2/k2 Uh, (Fh_j - Nh_j)_s' ; *, 1 ] >= 0` for every gain j and input s. A measurement error takes its part of
/// the limit.
pub(super) fn anti_windup(
    task: &Task,
    unknowns: &DesignUnknowns,
    strictness: &Strictness,
) -> Vec<Condition> {
    let level = task.invariant_level();
    let measurement = task.imperfections.measurement.as_ref();
    let reserve = |input: usize| measurement.map_or(0.0, |error| error.reserve[input]);
    let mut out = Vec::new();
    for rule in 0..unknowns.gain_count() {
        let at_rule = unknowns.with_rule(rule);
        let difference = match &at_rule.sector {
            Some(sector) => &at_rule.gain - &sector.anti_windup,
            None => at_rule.gain,
        };
        for (input, limit) in task.system.input_limit.iter().enumerate() {
            let limit = limit - reserve(input);
            let scaled = limit * limit / level * &unknowns.lyapunov;
            let beside = difference.row(input).transposed();
            let lhs = SymmetricBlocks::of(&[&[&scaled, &beside], &[&Affine::identity(1, 1.0)]]);
            let name = format!("anti-windup input {}", input + 1);
            let name = name + &gain_suffix(unknowns.gain_count(), rule);
            out.push(strictness.positive(name, lhs));
        }
    }
    out
}

/// ` gain 3` where there are several gains.
pub fn gain_suffix(count: usize, rule: usize) -> String {
    match count {
        1 => String::new(),
        _ => format!(" gain {}", rule + 1),
    }
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
