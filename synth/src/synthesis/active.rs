//! Which vertices matter, for models with many.

use nalgebra::DMatrix;

use super::assemble::MARGIN_UNIT;
use super::{Assembled, Goal};
use crate::conditions::xu2020::{decrease, vertex_term, Interval};
use crate::conditions::Task;
use crate::solve::Solution;

/// Vertices chosen before anything is known.
const FIRST_CHOICE: usize = 8;

/// Part of a condition's margin that a vertex left out may use up before it counts as violated.
const MARGIN_SHARE: f64 = 0.5;

/// Vertices far from each other: each next one is the farthest from those already chosen.
pub(super) fn first_choice(vertices: &[DMatrix<f64>]) -> Vec<usize> {
    let mut chosen = vec![0];
    let mut distance: Vec<f64> = vertices.iter().map(|v| (v - &vertices[0]).norm()).collect();
    while chosen.len() < FIRST_CHOICE.min(vertices.len()) {
        let farthest = (0..vertices.len()).max_by(|&a, &b| distance[a].total_cmp(&distance[b]));
        let Some(next) = farthest.filter(|&vertex| distance[vertex] > 0.0) else {
            break;
        };
        chosen.push(next);
        for (vertex, known) in distance.iter_mut().enumerate() {
            *known = known.min((&vertices[vertex] - &vertices[next]).norm());
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
    let required = match goal {
        Goal::SmallestGain | Goal::SmallestPeak | Goal::LargestReach { .. } => {
            MARGIN_SHARE * margin
        }
        Goal::LargestMargin { .. } | Goal::LargestRoom { .. } => {
            -MARGIN_SHARE * MARGIN_UNIT * solution.objective
        }
        Goal::SmallestSlack => MARGIN_SHARE * margin - solution.objective,
    };
    let design = &assembled.design;
    let n = task.system.states();
    let multiplier = design.multiplier.value(&solution.values);
    let nominal = Interval::BOTH.map(|interval| {
        let lhs = decrease(task, &DMatrix::zeros(n, n), interval, design);
        -lhs.value(&solution.values)
    });
    let smallest = |vertex: usize| {
        let term = vertex_term(task, &task.system.vertices[vertex], &multiplier);
        let eigenvalues = nominal.iter().map(|matrix| {
            let mut at_vertex = matrix.clone();
            let mut corner = at_vertex.view_mut((0, 0), (3 * n, 3 * n));
            corner -= &term;
            at_vertex.symmetric_eigenvalues().min()
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
    short.truncate(chosen.len());
    short.into_iter().map(|(vertex, _)| vertex).collect()
}
