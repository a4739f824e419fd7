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

use nalgebra::DMatrix;

use super::cliques::{self, Cliques, Split};
use crate::conditions::xu2020::{
    condition_name, decrease_form, Coordinates, DesignUnknowns, SamplingEnd, Strictness,
    DEAD_ZONE_UNIT,
};
use crate::conditions::Task;
use sdp::lmi::{Affine, Condition, SymmetricBlocks, Unknowns};

// Coordinates of the reduced condition: x, v, x(t_k^l), x(t_k), dead zone, tau, integral.
pub(super) const STATE: usize = 0;
pub(super) const MULTIPLIED: usize = 1;
pub(super) const SAMPLE: usize = 2;
pub(super) const HELD: usize = 3;
pub(super) const DEAD_ZONE: usize = 4;
pub(super) const DISTURBANCE: usize = 5;
pub(super) const INTEGRAL: usize = 6;

/// The reduced coordinates' block sizes for one end of the interval.
pub fn block_sizes(task: &Task, design: &DesignUnknowns, interval: SamplingEnd) -> Vec<usize> {
    let system = &task.system;
    let n = system.states();
    let m = design
        .sector
        .as_ref()
        .map_or(0, |sector| sector.weight.nrows());
    let mut sizes = vec![n, n, n, n, m, system.disturbance.ncols()];
    if interval == SamplingEnd::End {
        sizes.push(n);
    }
    sizes
}

/// The quantities of (18) in the reduced coordinates: x' = (v - eps1 x - eps3 x(t_k^l)) / eps2.
pub fn coordinates(task: &Task, design: &DesignUnknowns, interval: SamplingEnd) -> Coordinates {
    let sizes = block_sizes(task, design, interval);
    let total: usize = sizes.iter().sum();
    let select = |block: usize| {
        let offset: usize = sizes[..block].iter().sum();
        let mut out = DMatrix::zeros(sizes[block], total);
        out.view_mut((0, offset), (sizes[block], sizes[block]))
            .fill_with_identity();
        out
    };
    let [e1, e2, e3] = task.specification.multiplier_weights;
    let (state, multiplied, sample) = (select(STATE), select(MULTIPLIED), select(SAMPLE));
    let rate = (&multiplied - e1 * &state - e3 * &sample) / e2;
    Coordinates {
        rate,
        held: select(HELD),
        dead_zone: dead_zone_unit(design) * select(DEAD_ZONE),
        disturbance: select(DISTURBANCE),
        integral: match interval {
            SamplingEnd::Start => DMatrix::zeros(task.system.states(), total),
            SamplingEnd::End => select(INTEGRAL),
        },
        state,
        multiplied,
        sample,
    }
}

/// Unit of the dead-zone row.
fn dead_zone_unit(design: &DesignUnknowns) -> f64 {
    let sector = design.sector.as_ref();
    sector.map_or(DEAD_ZONE_UNIT, |sector| sector.row_unit)
}

/// The cliques {v, tau}, {v, w, p} (with sector unknowns), {v, xk, w}, {x, xk, s} (for r = 2) and the
/// root {x, v, xk}.
fn splits(design: &DesignUnknowns, interval: SamplingEnd) -> Vec<Split> {
    let split = |name, residual, separator| Split {
        name,
        residual,
        separator,
    };
    let mut out = vec![split("disturbance", vec![DISTURBANCE], vec![MULTIPLIED])];
    if design.sector.is_some() {
        out.push(split("dead zone", vec![DEAD_ZONE], vec![MULTIPLIED, HELD]));
    }
    out.push(split("held state", vec![HELD], vec![MULTIPLIED, SAMPLE]));
    if interval == SamplingEnd::End {
        out.push(split("integral", vec![INTEGRAL], vec![STATE, SAMPLE]));
    }
    out
}

/// The weight of the margin that equals the identity in the coordinates of the full condition.
pub(super) fn margin_weight(at: &Coordinates, design: &DesignUnknowns) -> DMatrix<f64> {
    let error = &at.sample - &at.held;
    let dead_zone = &at.dead_zone / dead_zone_unit(design);
    [
        &at.state,
        &at.rate,
        &at.sample,
        &error,
        &dead_zone,
        &at.disturbance,
        &at.integral,
    ]
    .iter()
    .fold(
        DMatrix::zeros(at.state.ncols(), at.state.ncols()),
        |sum, map| sum + map.transpose() * *map,
    )
}

/// Blocks that the vertex slack acts on: x and v, and x(t_k^l) where E_i brings it in.
fn slack_blocks(task: &Task) -> usize {
    let sampled = task.specification.multiplier_weights[2] != 0.0;
    match sampled && !task.system.descriptors.is_empty() {
        true => 3,
        false => 2,
    }
}

/// `Z - M_i >= 0` on the blocks of the slack at one vertex.
fn vertex_block(task: &Task, vertex: usize, design: &DesignUnknowns, slack: &Affine) -> Affine {
    let n = task.system.states();
    let blocks = slack_blocks(task);
    let mut block = SymmetricBlocks::new(&vec![n; blocks]);
    let q_at = &design.multiplier * &task.system.vertices[vertex].transpose();
    block.add(STATE, MULTIPLIED, &q_at);
    if let Some(descriptor) = task.system.descriptors.get(vertex) {
        // -2 v' (E_i - I) Qh' x' with x' = (v - eps1 x - eps3 x(t_k^l)) / eps2.
        let [e1, e2, e3] = task.specification.multiplier_weights;
        let change = descriptor - DMatrix::identity(n, n);
        let change = 1.0 / e2 * &(&design.multiplier * &change.transpose()); // Qh (E_i - I)' / eps2
        block.add(STATE, MULTIPLIED, &(e1 * &change));
        block.add(MULTIPLIED, MULTIPLIED, &-change.symmetrised());
        if blocks > SAMPLE {
            block.add(MULTIPLIED, SAMPLE, &(e3 * change.transposed()));
        }
    }
    slack - &block.finish()
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
    for interval in SamplingEnd::BOTH {
        let r = interval.index();
        let slack = unknowns.symmetric(&format!("Z{r}{suffix}"), slack_blocks(task) * n);
        let at = coordinates(task, design, interval);
        let mut lhs = decrease_form(task, interval, design, &at);
        lhs.add_block(0, 0, &slack);
        let strict = strictness.positive_against("", -lhs, &margin_weight(&at, design));
        let sizes = block_sizes(task, design, interval);
        let order = match cliques {
            Cliques::Split => splits(design, interval),
            Cliques::Whole => Vec::new(),
        };
        let parts = cliques::split(strict.expression(), &sizes, &order, unknowns)
            .unwrap_or_else(|error| unreachable!("the pattern of (18) is chordal: {error}"));
        for (clique, part) in parts {
            out.push(Condition::semidefinite(
                format!("decrease r={r}{suffix} clique {clique}"),
                part,
            ));
        }
        for &vertex in chosen {
            let part = vertex_block(task, vertex, design, &slack);
            out.push(Condition::semidefinite(
                condition_name(interval, vertex) + suffix,
                part,
            ));
        }
    }
    out
}
