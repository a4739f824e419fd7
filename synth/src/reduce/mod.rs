//! The exact size reduction of the decrease condition (18).
//!
//! Two steps, neither of which loses anything:
//! 1. [`vertex_slack`]: the vertices enter through one 2n x 2n block only, so one slack matrix takes
//!    the place of all of them and each vertex costs one small cone;
//! 2. [`cliques`]: in suitable coordinates the rest is chordal, so it splits into overlapping
//!    cliques.

//!
//! Several gains in any mixture: the same for each of them. Gains scheduled by the plant's own
//! memberships, up to a mismatch: [`rule_slack`].

pub mod cliques;
pub mod rule_slack;
pub mod vertex_slack;

pub use cliques::Cliques;

use crate::conditions::xu2020::{gain_suffix, DesignUnknowns, Strictness};
use crate::conditions::Task;
use sdp::lmi::{Condition, Unknowns};

/// (18) for the chosen vertices and both ends of the sampling interval, reduced.
pub fn decrease_conditions(
    task: &Task,
    chosen: &[usize],
    unknowns: &mut Unknowns,
    design: &DesignUnknowns,
    strictness: &Strictness,
    cliques: Cliques,
) -> Vec<Condition> {
    let one_by_one = cliques == Cliques::Whole && task.gains.given.is_some();
    match task.gains.matched() {
        None => {}
        // Without a mismatch every vertex may as well have the slack of its own gain.
        Some(kappa) if kappa == 0.0 && one_by_one => {}
        Some(_) => return rule_slack::conditions(task, unknowns, design, strictness),
    }
    let mut out = Vec::new();
    for rule in 0..design.gain_count() {
        let at_rule = design.with_rule(rule);
        let suffix = gain_suffix(design.gain_count(), rule);
        let how = (suffix.as_str(), cliques);
        let own = [rule];
        let chosen = match task.gains.matched() {
            Some(_) => &own,
            None => chosen,
        };
        out.extend(vertex_slack::conditions(
            task, chosen, unknowns, &at_rule, strictness, how,
        ));
    }
    out
}
