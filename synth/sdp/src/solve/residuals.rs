//! How good a candidate is, from its numbers alone.

use faer::Side;

use crate::backend::Solution;
use crate::lmi::{inner_product, svec_index, Cone, Semidefinite};

/// Error measures of a candidate, in the manner of the DIMACS challenge; all are zero at an exact solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residuals {
    /// `cost' y` plus the offset.
    pub objective: f64,
    /// `-sum <F0, Z>` plus the offset.
    pub dual_objective: f64,
    /// Their difference, relative to 1 plus their sizes.
    pub relative_gap: f64,
    /// How far the worst condition is from semidefinite, relative to 1 plus the largest constant entry.
    pub violation: f64,
    /// Norm of `<F_i, Z> - c_i` over the unknowns, relative to 1 plus the largest cost.
    pub dual_residual: f64,
    /// How far the worst dual matrix is from semidefinite, relative to 1 plus the largest cost.
    pub dual_violation: f64,
}

/// Measures a candidate.
pub fn residuals(problem: &Semidefinite, solution: &Solution) -> Residuals {
    let cost = problem.cost.iter();
    let objective: f64 = cost.zip(&solution.values).map(|(c, y)| c * y).sum();
    let mut products = vec![0.0; problem.cost.len()];
    let (mut dual_objective, mut lowest, mut dual_lowest) = (0.0, 0.0_f64, 0.0_f64);
    let mut largest = 0.0_f64;
    for (cone, dual) in problem.cones.iter().zip(&solution.duals) {
        dual_objective -= inner_product(&cone.constant, dual);
        for (unknown, entries) in &cone.coefficients {
            products[*unknown] += inner_product(entries, dual);
        }
        let sizes = cone.constant.iter().map(|entry| entry.value.abs());
        largest = sizes.fold(largest, f64::max);
        let slack = slack(cone, &solution.values);
        lowest = lowest.min(smallest_eigenvalue(&slack, cone.side));
        dual_lowest = dual_lowest.min(smallest_eigenvalue(dual, cone.side));
    }
    let squares = products
        .iter()
        .zip(&problem.cost)
        .map(|(a, c)| (a - c) * (a - c));
    let largest_cost = problem.cost.iter().fold(0.0_f64, |max, c| max.max(c.abs()));
    Residuals {
        objective: objective + problem.offset,
        dual_objective: dual_objective + problem.offset,
        relative_gap: (objective - dual_objective) / (1.0 + objective.abs() + dual_objective.abs()),
        violation: -lowest / (1.0 + largest),
        dual_residual: squares.sum::<f64>().sqrt() / (1.0 + largest_cost),
        dual_violation: -dual_lowest / (1.0 + largest_cost),
    }
}

/// The matrix of a cone at a point, as its upper triangle by columns.
fn slack(cone: &Cone, values: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; cone.height()];
    for entry in &cone.constant {
        out[svec_index(entry.row, entry.column)] += entry.value;
    }
    for (unknown, entries) in &cone.coefficients {
        for entry in entries {
            out[svec_index(entry.row, entry.column)] += values[*unknown] * entry.value;
        }
    }
    out
}

/// NaN when the matrix holds a number that is not finite or the eigenvalues cannot be found.
fn smallest_eigenvalue(upper: &[f64], side: usize) -> f64 {
    if !upper.iter().all(|entry| entry.is_finite()) {
        return f64::NAN;
    }
    let matrix = faer::Mat::from_fn(side, side, |i, j| upper[svec_index(i, j)]);
    match matrix.self_adjoint_eigenvalues(Side::Lower) {
        Ok(values) => values.into_iter().fold(f64::INFINITY, f64::min),
        Err(_) => f64::NAN,
    }
}
