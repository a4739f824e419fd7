//! Scheduled gains under a bound on the mismatch of the memberships.
//!
//! With delta = zeta(t_k) - zeta(t), sum delta_j = 0 and |delta_j| <= kappa, the gains add
//! `sum_j delta_j N_j` to what they are with the plant's own memberships, where N_j is the quadratic
//! form `2 (B'v)' Fh_j x(t_k) + 2 p' Nh_j x(t_k)` of gain j. For any symmetric R and P_j with
//! `P_j >= N_j - R` and `P_j >= R - N_j` this is at most `kappa sum_j P_j`. Nothing is lost by
//! stating P_j and R on (B'v, p, x(t_k)) only: the N_j do not see the rest of v, and it can be
//! minimised out of all P_j at once.

use super::unknowns::{DesignUnknowns, SamplingEnd, DEAD_ZONE_UNIT};
use crate::conditions::Task;
use sdp::lmi::{Affine, Condition, Strictness, SymmetricBlocks};

/// N_j on the rows of [`MismatchUnknowns`].
fn gain_form(unknowns: &DesignUnknowns, rule: usize) -> Affine {
    let at_rule = unknowns.with_rule(rule);
    let (m, n) = (at_rule.gain.nrows(), at_rule.gain.ncols());
    let zone = if at_rule.sector.is_some() { m } else { 0 };
    let mut out = SymmetricBlocks::new(&[m, zone, n]);
    out.add(0, 2, &at_rule.gain);
    if let Some(sector) = &at_rule.sector {
        out.add(1, 2, &(DEAD_ZONE_UNIT * &sector.anti_windup));
    }
    out.finish()
}

/// `P_j - N_j + R > 0` and `P_j + N_j - R > 0` for every gain and both ends of the interval.
pub(super) fn bounded(
    task: &Task,
    unknowns: &DesignUnknowns,
    strictness: &Strictness,
) -> Vec<Condition> {
    let mut out = Vec::new();
    for (slack, interval) in unknowns.mismatch.iter().zip(SamplingEnd::BOTH) {
        for (rule, bound) in slack.bounds.iter().enumerate().take(task.gains.count) {
            let difference = gain_form(unknowns, rule) - slack.common.clone();
            let r = interval.index();
            let name = |side: &str| format!("mismatch r={r} gain {} {side}", rule + 1);
            out.push(strictness.positive(name("above"), bound - &difference));
            out.push(strictness.positive(name("below"), bound + &difference));
        }
    }
    out
}
