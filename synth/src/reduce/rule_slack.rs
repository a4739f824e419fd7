//! One slack matrix for rules that come with their own gain.
//!
//! Under a mismatch bound, plant and gain of rule i enter (18) together, as the form
//! `2 v' A_i Qh' x + 2 v' B Fh_i x(t_k) + 2 p' Nh_i x(t_k)` on (x, v, x(t_k), p). As with a constant
//! gain, some Z_r above all of them takes their place, and nothing is lost. What is left over of v, tau
//! and the integral is split off as before; the root {x, v, x(t_k^l), x(t_k), p} stays whole, because
//! Z_r couples its blocks.

use nalgebra::DMatrix;

use super::cliques::{self, Split};
use super::vertex_slack::{
    block_sizes, coordinates, margin_weight, DEAD_ZONE, DISTURBANCE, HELD, INTEGRAL, MULTIPLIED,
    SAMPLE, STATE,
};
use crate::conditions::xu2020::{
    condition_name, decrease_form, DesignUnknowns, SamplingEnd, Strictness, DEAD_ZONE_UNIT,
};
use crate::conditions::Task;
use sdp::lmi::{Affine, Condition, SymmetricBlocks, Unknowns};

fn splits(interval: SamplingEnd) -> Vec<Split> {
    let mut out = vec![Split {
        name: "disturbance",
        residual: vec![DISTURBANCE],
        separator: vec![MULTIPLIED],
    }];
    if interval == SamplingEnd::End {
        out.push(Split {
            name: "integral",
            residual: vec![INTEGRAL],
            separator: vec![STATE, SAMPLE],
        });
    }
    out
}

/// Rows of the reduced coordinates, block after block.
fn select(sizes: &[usize], blocks: &[usize]) -> DMatrix<f64> {
    let total: usize = sizes.iter().sum();
    let height: usize = blocks.iter().map(|&block| sizes[block]).sum();
    let mut out = DMatrix::zeros(height, total);
    let mut row = 0;
    for &block in blocks {
        let offset: usize = sizes[..block].iter().sum();
        for k in 0..sizes[block] {
            out[(row + k, offset + k)] = 1.0;
        }
        row += sizes[block];
    }
    out
}

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
        let sizes = block_sizes(task, design, interval);
        let zone = sizes[DEAD_ZONE];
        let at = coordinates(task, design, interval);
        let place = select(&sizes, &[STATE, MULTIPLIED, HELD, DEAD_ZONE]);
        let slack = unknowns.symmetric(&format!("Z{r}"), place.nrows());
        let mut lhs = decrease_form(task, interval, &design.without_gain(), &at);
        lhs += &slack.congruence(&place);
        if let Some(mismatch) = design.mismatch.get(r - 1) {
            let mut seen = DMatrix::zeros(mismatch.common.nrows(), place.ncols());
            let (m, n) = (task.system.inputs(), task.system.states());
            let command = task.system.input.transpose() * &at.multiplied;
            seen.rows_mut(0, m).copy_from(&command);
            let zone_rows = select(&sizes, &[DEAD_ZONE]);
            seen.rows_mut(m, zone).copy_from(&zone_rows);
            seen.rows_mut(m + zone, n).copy_from(&at.held);
            lhs += &mismatch.total(task).congruence(&seen);
        }
        let strict = strictness.positive_against("", -lhs, &margin_weight(&at, design));
        let parts = cliques::split(strict.expression(), &sizes, &splits(interval), unknowns)
            .unwrap_or_else(|error| unreachable!("the pattern of (18) is chordal: {error}"));
        for (clique, part) in parts {
            let name = format!("decrease r={r} clique {clique}");
            out.push(Condition::semidefinite(name, part));
        }
        for rule in 0..task.system.vertices.len() {
            let part = &slack - &rule_block(task, rule, design, zone);
            out.push(Condition::semidefinite(
                condition_name(interval, rule),
                part,
            ));
        }
    }
    out
}
