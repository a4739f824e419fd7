//! The equations of dual matrices to the last digits.
//!
//! A Newton step is a solution of normal equations, whose condition is the square of that of the equations: where the
//! matrices have eigenvalues of very different sizes, the equations hold to a few digits only. Here the shortest
//! correction in the metric of the point comes from a rank-revealing factorization of the equations themselves, from
//! remainders that are summed in twice the precision.

use faer::Mat;
use nalgebra::DMatrix;

use super::{longest_step, upper, Equations};
use crate::lmi::{dual_matrix, Entry, Semidefinite};

/// Work [multiplications] above which nothing is refined.
const MOST_WORK: f64 = 2e10;

/// Corrections at most.
const CORRECTIONS: usize = 6;

/// A correction that leaves more than this part of the remainder is the last one.
const PROGRESS: f64 = 0.5;

/// Relative size of a pivot below which an equation follows from the others.
const DEPENDENT: f64 = 1e-14;

/// Positive definite dual matrices near the given ones that meet the equations of [`centred`](super::centred) to more
/// digits; `None` where there are none to be found.
pub fn refined(problem: &Semidefinite, duals: &[Vec<f64>], target: f64) -> Option<Vec<Vec<f64>>> {
    let equations = Equations::new(problem, target);
    let rows: usize = equations
        .blocks
        .iter()
        .map(|block| places(block.side))
        .sum();
    let count = equations.right.len() as f64;
    if rows as f64 * count * count > MOST_WORK {
        return None;
    }
    let sides = problem.cones.iter().map(|cone| cone.side);
    let mut point: Vec<DMatrix<f64>> = sides
        .zip(duals)
        .map(|(side, dual)| dual_matrix(side, dual))
        .collect();
    let mut remainder = equations.remainder(&point);
    let mut corrected = false;
    for _ in 0..CORRECTIONS {
        let step = equations.correction(&point, &remainder)?;
        let length = longest_step(&point, &step)?;
        let next: Vec<DMatrix<f64>> = point
            .iter()
            .zip(&step)
            .map(|(matrix, change)| matrix + length * change)
            .collect();
        let left = equations.remainder(&next);
        let (before, after) = (largest(&remainder), largest(&left));
        if after < before {
            (point, remainder, corrected) = (next, left, true);
        }
        if after.is_nan() || after > PROGRESS * before {
            break;
        }
    }
    corrected.then(|| point.iter().map(upper).collect())
}

fn largest(values: &[f64]) -> f64 {
    values
        .iter()
        .fold(0.0, |largest, value| value.abs().max(largest))
}

/// Entries of a triangle.
fn places(side: usize) -> usize {
    side * (side + 1) / 2
}

/// A sum in twice the precision.
#[derive(Clone, Copy, Default)]
struct Sum {
    high: f64,
    low: f64,
}

impl Sum {
    fn add(&mut self, value: f64) {
        let sum = self.high + value;
        let own = sum - self.high;
        self.low += (self.high - (sum - own)) + (value - own);
        self.high = sum;
    }

    fn add_product(&mut self, a: f64, b: f64) {
        let product = a * b;
        self.add(product);
        self.low += a.mul_add(b, -product);
    }

    fn value(self) -> f64 {
        self.high + self.low
    }
}

impl Equations<'_> {
    /// What is missing in each equation.
    fn remainder(&self, point: &[DMatrix<f64>]) -> Vec<f64> {
        let mut sums = vec![Sum::default(); self.right.len()];
        for (sum, right) in sums.iter_mut().zip(&self.right) {
            sum.add(*right);
        }
        for (block, z) in self.blocks.iter().zip(point) {
            for (row, entries) in &block.rows {
                for entry in *entries {
                    // A count of 1 or 2 is exact.
                    let weight = -entry.count() * entry.value;
                    sums[*row].add_product(weight, z[(entry.row, entry.column)]);
                }
            }
        }
        sums.into_iter().map(Sum::value).collect()
    }

    /// The change with the smallest sum of the squares of L^-1 dZ L^-T, Z = LL', that makes up for the remainder.
    fn correction(&self, point: &[DMatrix<f64>], remainder: &[f64]) -> Option<Vec<DMatrix<f64>>> {
        let roots = point.iter().map(|z| Some(z.clone().cholesky()?.unpack()));
        let roots: Vec<DMatrix<f64>> = roots.collect::<Option<_>>()?;
        let rows: usize = roots.iter().map(|root| places(root.nrows())).sum();
        let count = self.right.len();
        let mut matrix = Mat::<f64>::zeros(rows, count);
        let mut from = 0;
        for (block, root) in self.blocks.iter().zip(&roots) {
            for (equation, entries) in &block.rows {
                let image = congruence(entries, root);
                let mut at = from;
                for column in 0..block.side {
                    for row in 0..=column {
                        let weight = if row == column { 1.0 } else { f64::sqrt(2.0) };
                        matrix[(at, *equation)] += weight * image[(row, column)];
                        at += 1;
                    }
                }
            }
            from += places(block.side);
        }
        let mut right = remainder.to_vec();
        for (column, right) in right.iter_mut().enumerate() {
            let length = matrix.col(column).norm_l2();
            if length > 0.0 {
                *right /= length;
                let unit = 1.0 / length;
                matrix.col_mut(column).iter_mut().for_each(|x| *x *= unit);
            }
        }
        let change = shortest(&matrix, &right)?;
        let mut from = 0;
        let step = roots.iter().map(|root| {
            let side = root.nrows();
            let mut image = DMatrix::zeros(side, side);
            let mut at = from;
            for column in 0..side {
                for row in 0..=column {
                    let weight = if row == column { 1.0 } else { f64::sqrt(0.5) };
                    image[(row, column)] = weight * change[at];
                    image[(column, row)] = image[(row, column)];
                    at += 1;
                }
            }
            from = at;
            root * image * root.transpose()
        });
        Some(step.collect())
    }
}

/// The shortest w with `matrix' w = right`; dependent columns are left out.
fn shortest(matrix: &Mat<f64>, right: &[f64]) -> Option<Vec<f64>> {
    let factors = matrix.col_piv_qr();
    let (order, _) = factors.P().arrays();
    let upper = factors.thin_R();
    let rank = upper.nrows().min(upper.ncols());
    let largest = upper[(0, 0)].abs();
    let mut weights: Vec<f64> = Vec::with_capacity(rank);
    for k in 0..rank {
        let pivot = upper[(k, k)];
        if pivot.abs() <= DEPENDENT * largest {
            break;
        }
        let known = weights.iter().enumerate();
        let known: f64 = known.map(|(j, weight)| upper[(j, k)] * weight).sum();
        weights.push((right[order[k]] - known) / pivot);
    }
    let directions = factors.compute_thin_Q();
    let mut out = vec![0.0; matrix.nrows()];
    for (column, weight) in weights.iter().enumerate() {
        let direction = directions.col(column);
        out.iter_mut()
            .zip(direction.iter())
            .for_each(|(out, q)| *out += weight * q);
    }
    out.iter().all(|value| value.is_finite()).then_some(out)
}

/// `L' F L`.
fn congruence(entries: &[Entry], root: &DMatrix<f64>) -> DMatrix<f64> {
    let side = root.nrows();
    let mut product = DMatrix::zeros(side, side);
    for entry in entries {
        let (r, c) = (entry.row, entry.column);
        for column in 0..side {
            product[(r, column)] += entry.value * root[(c, column)];
            if r != c {
                product[(c, column)] += entry.value * root[(r, column)];
            }
        }
    }
    root.transpose() * product
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lmi::Cone;

    fn diagonal(values: &[f64]) -> Vec<Entry> {
        let places = values.iter().enumerate();
        let entries = places.map(|(k, &value)| Entry {
            row: k,
            column: k,
            value,
        });
        entries.filter(|entry| entry.value != 0.0).collect()
    }

    #[test]
    fn equations_hold_to_rounding_beside_a_tiny_eigenvalue() {
        // Z11 + Z22 = 1, 1e-4 Z11 + Z22 = 1e-4 + 1e-10 (1 - 1e-4): Z = diag(1 - 1e-10, 1e-10).
        let tiny = 1e-10;
        let cone = Cone {
            name: String::new(),
            side: 2,
            constant: diagonal(&[1.0, 1.0]),
            coefficients: vec![(0, diagonal(&[1e-4, 1.0]))],
        };
        let problem = Semidefinite {
            cost: vec![1e-4 + tiny * (1.0 - 1e-4)],
            offset: 0.0,
            cones: vec![cone],
        };
        let start = vec![vec![1.0 - 1e-8, 0.0, 1.5 * tiny]];
        let found = refined(&problem, &start, 1.0).unwrap();
        assert!((found[0][2] / tiny - 1.0).abs() < 1e-4, "{found:?}");
        assert!((found[0][0] + found[0][2] - 1.0).abs() < 1e-15);
    }
}
