//! Condition (18): the Lyapunov functional decreases between samples.

use nalgebra::DMatrix;

use super::signals::{terms, terms_at, vertex_terms, Basis};
use super::unknowns::{DesignUnknowns, SamplingEnd};
use crate::conditions::Task;
use sdp::lmi::{Affine, Condition, Strictness};

/// The matrix Xi + Omega_r of (18) at one vertex, in the rows of the paper (corrected terms: Xi_12 carries Uh and no
/// L; Xi_45 and Xi_55 as derived for the held state and S = M^-1).
/// Without sector unknowns the dead-zone row is left out; with them it is in units of its own.
/// Side 4n + m + d for r = 1 and 5n + m + d for r = 2. It must be negative definite.
pub fn decrease(
    task: &Task,
    vertex: &DMatrix<f64>,
    interval: SamplingEnd,
    unknowns: &DesignUnknowns,
) -> Affine {
    let mut all = terms(task, interval, unknowns);
    all.extend(vertex_terms((vertex, None), &unknowns.multiplier));
    Basis::published(task, interval, unknowns).form(&all)
}

/// [`decrease`] at one of the model's vertices, with that vertex's own E_i.
fn decrease_at(
    task: &Task,
    index: usize,
    interval: SamplingEnd,
    unknowns: &DesignUnknowns,
) -> Affine {
    let all = terms_at(task, interval, unknowns, index);
    Basis::published(task, interval, unknowns).form(&all)
}

/// The full-size condition (18) at one vertex, for the (first) gain.
pub fn full_condition(
    task: &Task,
    index: usize,
    interval: SamplingEnd,
    unknowns: &DesignUnknowns,
    strictness: &Strictness,
) -> Condition {
    let lhs = decrease_at(task, index, interval, unknowns);
    strictness.positive(condition_name(interval, index), -lhs)
}

/// The full-size condition (18) at one vertex with its own gain, and what the mismatch of the
/// memberships may add.
pub fn full_matched_condition(
    task: &Task,
    index: usize,
    interval: SamplingEnd,
    unknowns: &DesignUnknowns,
    strictness: &Strictness,
) -> Condition {
    let at_rule = unknowns.with_rule(index);
    let mut lhs = decrease_at(task, index, interval, &at_rule);
    if let Some(slack) = unknowns.mismatch.get(interval.index() - 1) {
        lhs += &slack
            .total(task)
            .congruence(&Basis::published(task, interval, unknowns).mismatch_rows(task));
    }
    strictness.positive(condition_name(interval, index), -lhs)
}

/// Name of (18) at one vertex, counted from 1 as in the paper.
pub fn condition_name(interval: SamplingEnd, index: usize) -> String {
    format!("decrease{} vertex {}", interval.label(), index + 1)
}
