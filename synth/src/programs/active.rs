//! Which vertices matter, for models with many.

use nalgebra::DMatrix;

use super::assemble::{Assembled, Goal, MARGIN_UNIT};
use crate::conditions::xu2020::{decrease, vertex_term_at, SamplingEnd};
use crate::conditions::Task;
use crate::fuzzy::TakagiSugeno;
use sdp::solve::Solution;

/// Number of vertices in the first relaxation.
const FIRST_CHOICE: usize = 8;

/// The same where the inertia is uncertain: the vertices are many, and a wrong start costs rounds.
const FIRST_CHOICE_OF_SET: usize = 24;

/// Fraction of a condition's margin that a vertex left out may use up before it counts as violated.
const MARGIN_SHARE: f64 = 0.5;

/// The same for the largest margin where the inertia is uncertain: nearly all vertices come near to the
/// margin then.
const MARGIN_SHARE_OF_SET: f64 = 0.9;

/// Vertices of an uncertain inertia that are closer to each other than this part of the largest distance
/// are not added in one round: small off-diagonal entries make many that are nearly alike, and one of
/// them often satisfies the others.
const ALIKE: f64 = 0.25;

/// Vertices far from each other: each next one is the farthest from those already chosen.
pub(super) fn first_choice(system: &TakagiSugeno) -> Vec<usize> {
    let between = |a: usize, b: usize| distance_between(system, a, b);
    let count = system.vertices.len();
    let wanted = match system.descriptors.is_empty() {
        true => FIRST_CHOICE,
        false => FIRST_CHOICE_OF_SET,
    };
    let mut chosen = vec![0];
    let mut distance: Vec<f64> = (0..count).map(|vertex| between(vertex, 0)).collect();
    while chosen.len() < wanted.min(count) {
        let farthest = (0..count).max_by(|&a, &b| distance[a].total_cmp(&distance[b]));
        let Some(next) = farthest.filter(|&vertex| distance[vertex] > 0.0) else {
            break;
        };
        chosen.push(next);
        for (vertex, known) in distance.iter_mut().enumerate() {
            *known = known.min(between(vertex, next));
        }
    }
    chosen
}

/// The vertices, among those not chosen, whose condition (18) a solution violates most.
pub(super) fn violated(
    task: &Task,
    goal: Goal,
    assembled: &Assembled,
    solution: &Solution,
    chosen: &[usize],
) -> Vec<usize> {
    let margin = task.specification.margin;
    let share = match task.system.descriptors.is_empty() {
        true => MARGIN_SHARE,
        false => MARGIN_SHARE_OF_SET,
    };
    let required = match goal {
        Goal::SmallestGain | Goal::SmallestPeak | Goal::LargestScale { .. } => {
            MARGIN_SHARE * margin
        }
        Goal::LargestMargin { .. } | Goal::LargestMarginAtPeak { .. } => {
            -(1.0 - share) * MARGIN_UNIT * solution.objective
        }
        Goal::SmallestSlack => MARGIN_SHARE * margin - solution.objective,
    };
    let design = &assembled.design;
    let n = task.system.states();
    let multiplier = design.multiplier.value(&solution.values);
    let instants = SamplingEnd::of(task).iter();
    let nominal = instants.map(|&interval| {
        let lhs = decrease(task, &DMatrix::zeros(n, n), interval, design);
        -lhs.value(&solution.values)
    });
    let nominal: Vec<DMatrix<f64>> = nominal.collect();
    let smallest = |vertex: usize| {
        let term = vertex_term_at(task, vertex, &multiplier);
        let eigenvalues = nominal.iter().map(|matrix| {
            let mut at_vertex = matrix.clone();
            let mut corner = at_vertex.view_mut((0, 0), (3 * n, 3 * n));
            corner -= &term;
            // Most vertices are satisfied, which a factorization shows sooner.
            let room = &at_vertex - DMatrix::identity(matrix.nrows(), matrix.nrows()) * required;
            match room.cholesky() {
                Some(_) => required,
                None => at_vertex.symmetric_eigenvalues().min(),
            }
        });
        eigenvalues.fold(f64::INFINITY, f64::min)
    };
    let others = (0..task.system.vertices.len()).filter(|vertex| !chosen.contains(vertex));
    let mut short: Vec<(usize, f64)> = others
        .map(|vertex| (vertex, smallest(vertex)))
        .filter(|(_, eigenvalue)| *eigenvalue < required)
        .collect();
    short.sort_by(|a, b| a.1.total_cmp(&b.1));
    // At most doubling keeps the number of rounds logarithmic.
    let mut out: Vec<usize> = Vec::new();
    let alike = alike_below(&task.system);
    for (vertex, _) in short {
        let unlike = |&added: &usize| distance_between(&task.system, vertex, added) >= alike;
        if out.len() < chosen.len() && out.iter().all(unlike) {
            out.push(vertex);
        }
    }
    out
}

/// Distance of two vertices as pairs (A_i, E_i).
fn distance_between(system: &TakagiSugeno, a: usize, b: usize) -> f64 {
    let states = (&system.vertices[a] - &system.vertices[b]).norm();
    let descriptors = system.descriptors.get(a).zip(system.descriptors.get(b));
    states.hypot(descriptors.map_or(0.0, |(a, b)| (a - b).norm()))
}

/// Distance below which two vertices are alike; 0 where the inertia is known.
fn alike_below(system: &TakagiSugeno) -> f64 {
    if system.descriptors.is_empty() {
        return 0.0;
    }
    let from_first = (0..system.vertices.len()).map(|vertex| distance_between(system, 0, vertex));
    ALIKE * from_first.fold(0.0, f64::max)
}
