//! One slack matrix instead of one large condition for each vertex.
//!
//! A_i enters (18) only through `2 v' A_i Qh' x` with v = eps1 x + eps2 x' + eps3 x(t_k^l), that is
//! through M_i = [0, Qh A_i'; A_i Qh', 0] on (x, v). The conditions hold for every vertex exactly
//! when some Z_r >= M_i (all i) satisfies the r-th condition with Z_r in the place of M_i: take for
//! Z_r the Schur complement of the rest.
//!
//! With an uncertain inertia the term is `2 v' (A_i Qh' x - (E_i - I) Qh' x')`, which x(t_k^l) enters too when
//! eps3 is not 0, because v determines x' in terms of x, v and x(t_k^l). The slack then acts on these three;
//! the argument is the same.

use super::cliques::{split_conditions, Cliques};
use crate::conditions::xu2020::{
    condition_name, terms, vertex_terms_at, Basis, DesignUnknowns, SamplingEnd, Signal, Strictness,
};
use crate::conditions::Task;
use sdp::lmi::{Affine, Condition, Unknowns};

/// The signals that are eliminated from the form in the reduced coordinates, in this order: the cliques {tau, v},
/// {z, w, p} (with a gain error), {p, v, w} (with sector unknowns), {w, v, xk}, {s, x, xk} (for r = 2) and the root {x, v, xk}.
pub const ELIMINATED: [Signal; 5] = [
    Signal::Disturbance,
    Signal::GainError,
    Signal::DeadZone,
    Signal::Held,
    Signal::Integral,
];

/// Blocks that the vertex slack acts on: x and v, and x(t_k^l) where E_i brings it in.
fn slack_blocks(task: &Task) -> usize {
    let sampled = task.specification.multiplier_weights[2] != 0.0;
    match sampled && !task.system.descriptors.is_empty() {
        true => 3,
        false => 2,
    }
}

/// `Z - M_i >= 0` on the blocks of the slack, x, v and perhaps x(t_k^l), at one vertex.
fn vertex_block(
    task: &Task,
    vertex: usize,
    design: &DesignUnknowns,
    (basis, slack): (&Basis, &Affine),
) -> Affine {
    let side = slack.nrows();
    let term = basis.form(&vertex_terms_at(task, vertex, &design.multiplier));
    slack - &term.view(0, 0, side, side)
}

/// (18) for the chosen vertices (indices into the model's), both ends of the interval and the (first)
/// gain. `suffix` ends the conditions' names.
pub fn conditions(
    task: &Task,
    chosen: &[usize],
    unknowns: &mut Unknowns,
    design: &DesignUnknowns,
    strictness: &Strictness,
    (suffix, cliques): (&str, Cliques),
) -> Vec<Condition> {
    let n = task.system.states();
    let mut out = Vec::new();
    for &interval in SamplingEnd::of(task) {
        let r = interval.index();
        let slack = unknowns.symmetric(&format!("Z{r}{suffix}"), slack_blocks(task) * n);
        let basis = Basis::reduced(task, interval, design);
        let common = terms(task, interval, design);
        let mut lhs = basis.form(&common);
        lhs.add_block(0, 0, &slack);
        let order = (cliques == Cliques::Split).then_some(&ELIMINATED[..]);
        let stated = (&basis, common.as_slice(), order);
        let place = format!("{}{suffix}", interval.label());
        out.extend(split_conditions(lhs, stated, strictness, unknowns, &place));
        for &vertex in chosen {
            let part = vertex_block(task, vertex, design, (&basis, &slack));
            let name = condition_name(interval, vertex) + suffix;
            out.push(Condition::semidefinite(name, part));
        }
    }
    out
}
