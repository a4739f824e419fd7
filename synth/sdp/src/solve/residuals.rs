//! How good a candidate is, from its numbers alone.

use faer::Side;

use crate::backend::Solution;
use crate::lmi::{dual_trace, inner_product, svec_index, Cone, Semidefinite};

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
    /// How far the objective may be from the optimum, relative to 1 plus the sizes of both objectives: the gap, and
    /// what the residuals and violations can amount to at unknowns and dual matrices of the candidate's size. An
    /// estimate: the size of a true solution is not known.
    pub uncertainty: f64,
}

/// Measures a candidate. Every number is NaN that a number which is not finite takes part in.
pub fn residuals(problem: &Semidefinite, solution: &Solution) -> Residuals {
    let cost = problem.cost.iter();
    let objective: f64 = cost.zip(&solution.values).map(|(c, y)| c * y).sum();
    let mut products = vec![0.0; problem.cost.len()];
    let (mut dual_objective, mut lowest, mut dual_lowest) = (0.0, 0.0_f64, 0.0_f64);
    let mut largest = 0.0_f64;
    // By how much the objectives can differ from the optimum because the point and its dual violate their conditions.
    let mut doubt = 0.0;
    for (cone, dual) in problem.cones.iter().zip(&solution.duals) {
        dual_objective -= inner_product(&cone.constant, dual);
        for (unknown, entries) in &cone.coefficients {
            products[*unknown] += inner_product(entries, dual);
        }
        let sizes = cone.constant.iter().map(|entry| entry.value.abs());
        largest = sizes.fold(largest, f64::max);
        let slack = slack(cone, &solution.values);
        let (least, dual_least) = (
            smallest_eigenvalue(&slack, cone.side),
            smallest_eigenvalue(dual, cone.side),
        );
        lowest = lower(lowest, least);
        dual_lowest = lower(dual_lowest, dual_least);
        doubt += lower(0.0, least).abs() * dual_trace(cone.side, dual).abs()
            + lower(0.0, dual_least).abs() * dual_trace(cone.side, &slack).abs();
    }
    let differences = products.iter().zip(&problem.cost).map(|(a, c)| a - c);
    let squares: f64 = differences.clone().map(|d| d * d).sum();
    let moved = differences.zip(&solution.values);
    doubt += moved.map(|(d, y)| (d * y).abs()).sum::<f64>();
    let largest_cost = problem.cost.iter().fold(0.0_f64, |max, c| max.max(c.abs()));
    let size = 1.0 + objective.abs() + dual_objective.abs();
    let gap = objective - dual_objective;
    Residuals {
        objective: objective + problem.offset,
        dual_objective: dual_objective + problem.offset,
        relative_gap: gap / size,
        violation: (0.0 - lowest) / (1.0 + largest),
        dual_residual: squares.sqrt() / (1.0 + largest_cost),
        dual_violation: (0.0 - dual_lowest) / (1.0 + largest_cost),
        uncertainty: (gap.abs() + doubt) / size,
    }
}

/// The lower of two numbers, NaN when one of them is.
fn lower(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else {
        a.min(b)
    }
}

/// The matrix of a cone at a point, as its upper triangle by columns.
pub(super) fn slack(cone: &Cone, values: &[f64]) -> Vec<f64> {
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
pub(super) fn smallest_eigenvalue(upper: &[f64], side: usize) -> f64 {
    if !upper.iter().all(|entry| entry.is_finite()) {
        return f64::NAN;
    }
    let matrix = faer::Mat::from_fn(side, side, |i, j| upper[svec_index(i, j)]);
    match matrix.self_adjoint_eigenvalues(Side::Lower) {
        Ok(values) => values.into_iter().fold(f64::INFINITY, f64::min),
        Err(_) => f64::NAN,
    }
}
