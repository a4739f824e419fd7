//! Certificates that a program has no solution or no optimum, measured and, where possible, proved.

use verified::definite::{prove_positive_definite, IntervalMatrix};
use verified::interval::Interval;

use super::residuals::smallest_eigenvalue;
use crate::exclusion::{exclude, Exclusion};
use crate::lmi::{inner_product, svec_index, Cone, Entry, Semidefinite};

/// Dual matrices as a certificate that no point satisfies the conditions.
#[derive(Debug, Clone, PartialEq)]
pub struct Refutation {
    /// Sum over the unknowns of `|<F_i, Z>| / min |F_i|`, relative to `-<F0, Z> / max |F0|`: no point has every
    /// `|y_i| min |F_i|` below `max |F0|` over this. The minimum is over the entries that are not zero: an unknown may
    /// have to be as large as the smallest of them asks. Infinite when `<F0, Z>` is not negative.
    pub residual: f64,
    /// What they exclude, proved in interval arithmetic.
    pub exclusion: Exclusion,
}

/// Measures dual matrices, given as in [`Solution::duals`](crate::solve::Solution::duals).
pub fn refutation(problem: &Semidefinite, duals: &[Vec<f64>]) -> Refutation {
    let unknowns = problem.cost.len();
    let (mut products, mut sizes) = (vec![0.0; unknowns], vec![f64::INFINITY; unknowns]);
    let (mut strength, mut size) = (0.0, 0.0_f64);
    for (cone, dual) in problem.cones.iter().zip(duals) {
        strength -= inner_product(&cone.constant, dual);
        size = size.max(largest(&cone.constant));
        for (unknown, entries) in &cone.coefficients {
            products[*unknown] += inner_product(entries, dual);
            sizes[*unknown] = sizes[*unknown].min(smallest(entries));
        }
    }
    let relative = products
        .iter()
        .zip(&sizes)
        .filter(|(_, size)| size.is_finite());
    let relative: f64 = relative.map(|(product, size)| product.abs() / size).sum();
    let residual = match strength > 0.0 && relative.is_finite() {
        true => relative / (strength / size),
        false => f64::INFINITY,
    };
    Refutation {
        residual,
        exclusion: exclude(problem, duals),
    }
}

/// A direction in which the objective falls for ever.
#[derive(Debug, Clone, PartialEq)]
pub struct Descent {
    /// How far `sum_i d_i F_i` is from semidefinite: its smallest eigenvalue, negated, relative to
    /// `sum_i |d_i| max |F_i|`, in the worst cone.
    pub residual: f64,
    /// Proved in interval arithmetic: the objective falls, and `sum_i d_i F_i` is positive definite, so that there are
    /// points that satisfy the conditions, with objectives below any bound.
    pub proved: bool,
}

/// Measures a direction, or, where an unknown with a cost occurs in no condition, that unknown's. `None` where the
/// objective does not fall.
pub fn descent(problem: &Semidefinite, direction: &[f64]) -> Option<Descent> {
    let free = free_direction(problem);
    let direction = free.as_deref().unwrap_or(direction);
    let fall = problem.cost.iter().zip(direction);
    let fall = fall.fold(Interval::ZERO, |sum, (&c, &d)| {
        sum - Interval::from(c) * Interval::from(d)
    });
    if !(fall.lo() > 0.0 && direction.iter().all(|d| d.is_finite())) {
        return None;
    }
    let mut descent = Descent {
        residual: 0.0,
        proved: true,
    };
    for cone in &problem.cones {
        let sizes = cone.coefficients.iter();
        let size: f64 = sizes.map(|(u, e)| direction[*u].abs() * largest(e)).sum();
        let sum = along(cone, direction);
        let upper: Vec<f64> = sum.iter().map(|entry| entry.midpoint()).collect();
        let violation = -smallest_eigenvalue(&upper, cone.side);
        if size > 0.0 || violation.is_nan() {
            let relative = violation / size;
            // NaN stays: nothing is above it.
            if relative.is_nan() || relative > descent.residual {
                descent.residual = relative;
            }
        }
        let entry = |i: usize, j: usize| sum[svec_index(i, j)];
        descent.proved &= violation < 0.0
            && prove_positive_definite(&IntervalMatrix::from_upper(cone.side, entry)).is_ok();
    }
    Some(descent)
}

/// `sum_i d_i F_i` of a cone, as its upper triangle by columns.
fn along(cone: &Cone, direction: &[f64]) -> Vec<Interval> {
    let mut sum = vec![Interval::ZERO; cone.height()];
    for (unknown, entries) in &cone.coefficients {
        for entry in entries {
            let place = svec_index(entry.row, entry.column);
            sum[place] += Interval::from(direction[*unknown]) * Interval::from(entry.value);
        }
    }
    sum
}

/// The direction of an unknown that has a cost and occurs in no condition.
fn free_direction(problem: &Semidefinite) -> Option<Vec<f64>> {
    let mut used = vec![false; problem.cost.len()];
    for (unknown, entries) in problem.cones.iter().flat_map(|cone| &cone.coefficients) {
        used[*unknown] |= entries.iter().any(|entry| entry.value != 0.0);
    }
    let free = (0..used.len()).find(|&u| !used[u] && problem.cost[u] != 0.0)?;
    let mut direction = vec![0.0; used.len()];
    direction[free] = -problem.cost[free].signum();
    Some(direction)
}

fn largest(entries: &[Entry]) -> f64 {
    let sizes = entries.iter().map(|entry| entry.value.abs());
    sizes.fold(0.0, f64::max)
}

/// Of the entries that are not zero; infinite without one.
fn smallest(entries: &[Entry]) -> f64 {
    let sizes = entries.iter().map(|entry| entry.value.abs());
    sizes
        .filter(|size| *size > 0.0)
        .fold(f64::INFINITY, f64::min)
}
