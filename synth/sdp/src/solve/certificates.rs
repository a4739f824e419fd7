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
    /// How far `sum_i d_i F_i` is from semidefinite: its smallest eigenvalue, negated, after every row and column is
    /// divided by the root of `sum_i |d_i| max |F_i|` over the row's entries, so that units of rows do not matter; in the
    /// worst cone.
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
        let sum = along(cone, direction);
        let violation = violation(cone, direction, &sum);
        // NaN stays: nothing is above it.
        if violation.is_nan() || violation > descent.residual {
            descent.residual = violation;
        }
        let entry = |i: usize, j: usize| sum[svec_index(i, j)];
        descent.proved &= violation < 0.0
            && prove_positive_definite(&IntervalMatrix::from_upper(cone.side, entry)).is_ok();
    }
    Some(descent)
}

/// The smallest eigenvalue of `sum_i d_i F_i`, negated, in the unit of each row: the sum of its terms' magnitudes.
fn violation(cone: &Cone, direction: &[f64], sum: &[Interval]) -> f64 {
    let mut units = vec![0.0; cone.side];
    for (unknown, entries) in &cone.coefficients {
        let mut own = vec![0.0_f64; cone.side];
        for entry in entries {
            for row in [entry.row, entry.column] {
                own[row] = own[row].max(entry.value.abs());
            }
        }
        let terms = units.iter_mut().zip(own);
        terms.for_each(|(unit, size)| *unit += direction[*unknown].abs() * size);
    }
    // A row without terms is zero in any unit.
    let unit = |row: usize| {
        if units[row] > 0.0 {
            units[row].sqrt()
        } else {
            1.0
        }
    };
    let mut scaled = vec![0.0; cone.height()];
    for column in 0..cone.side {
        for row in 0..=column {
            let place = svec_index(row, column);
            scaled[place] = sum[place].midpoint() / unit(row) / unit(column);
        }
    }
    -smallest_eigenvalue(&scaled, cone.side)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_entry_that_falls_is_no_less_of_a_violation_than_a_large_one() {
        // [u y0, 0; 0, y1]: y0 must not fall, whatever the unit of its row.
        let entry = |row, value| Entry {
            row,
            column: row,
            value,
        };
        for unit in [1.0, 1e-15] {
            let problem = Semidefinite {
                cost: vec![1.0, 4.0],
                offset: 0.0,
                cones: vec![Cone {
                    name: "both".into(),
                    side: 2,
                    constant: Vec::new(),
                    coefficients: vec![(0, vec![entry(0, unit)]), (1, vec![entry(1, 1.0)])],
                }],
            };
            let falling = descent(&problem, &[-1.0, 0.01]).expect("the objective falls");
            assert!((falling.residual - 1.0).abs() < 1e-12, "{falling:?}");
            assert!(!falling.proved);
        }
    }
}
