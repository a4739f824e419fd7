//! One slack matrix for rules that come with their own gain.
//!
//! Under a mismatch bound, plant and gain of rule i enter (18) together, as the form
//! `2 v' A_i Qh' x + 2 v' B Fh_i x(t_k) + 2 p' Nh_i x(t_k)` on (x, v, x(t_k), p). As with a constant
//! gain, some Z_r above all of them takes their place, and nothing is lost. What is left over of v, tau
//! and the integral is split off as before; the root {x, v, x(t_k^l), x(t_k), p} stays whole, because
//! Z_r couples its blocks.

use super::cliques::split_conditions;
use crate::conditions::xu2020::{
    condition_name, terms, Basis, DesignUnknowns, SamplingEnd, Signal, Strictness, DEAD_ZONE_UNIT,
};
use crate::conditions::Task;
use sdp::lmi::{Affine, Condition, SymmetricBlocks, Unknowns};

/// The signals that are eliminated: those that Z_r does not couple.
const ELIMINATED: [Signal; 2] = [Signal::Disturbance, Signal::Integral];

/// The signals that Z_r acts on.
const COUPLED: [Signal; 4] = [
    Signal::State,
    Signal::Multiplied,
    Signal::Held,
    Signal::DeadZone,
];

/// The form of one rule on (x, v, x(t_k), p).
fn rule_block(task: &Task, rule: usize, design: &DesignUnknowns, zone: usize) -> Affine {
    let n = task.system.states();
    let at_rule = design.with_rule(rule);
    let mut out = SymmetricBlocks::new(&[n, n, n, zone]);
    let plant = &design.multiplier * &task.system.vertices[rule].transpose();
    out.add(0, 1, &plant);
    out.add(1, 2, &(&task.system.input * &at_rule.gain));
    if let Some(sector) = &at_rule.sector {
        let anti_windup = DEAD_ZONE_UNIT * sector.anti_windup.transposed();
        out.add(2, 3, &anti_windup);
    }
    out.finish()
}

/// (18) for every rule with its own gain and both ends of the interval.
pub fn conditions(
    task: &Task,
    unknowns: &mut Unknowns,
    design: &DesignUnknowns,
    strictness: &Strictness,
) -> Vec<Condition> {
    let mut out = Vec::new();
    for interval in SamplingEnd::BOTH {
        let r = interval.index();
        let free = design.without_gain();
        let basis = Basis::reduced(task, interval, &free);
        let zone = basis
            .block(Signal::DeadZone)
            .map_or(0, |block| basis.sizes()[block]);
        let place = basis.selected(&COUPLED);
        let slack = unknowns.symmetric(&format!("Z{r}"), place.nrows());
        let common = terms(task, interval, &free);
        let mut lhs = basis.form(&common);
        lhs += &slack.congruence(&place);
        if let Some(mismatch) = design.mismatch.get(r - 1) {
            let total = mismatch.total(task);
            lhs += &total.congruence(&basis.mismatch_rows(task));
        }
        let stated = (&basis, common.as_slice(), Some(&ELIMINATED[..]));
        let place = interval.label();
        out.extend(split_conditions(lhs, stated, strictness, unknowns, place));
        for rule in 0..task.system.vertices.len() {
            let part = &slack - &rule_block(task, rule, design, zone);
            let name = condition_name(interval, rule);
            out.push(Condition::semidefinite(name, part));
        }
    }
    out
}
