//! The analytic centre of the dual solutions that suffice for a proof.
//!
//! A solver's dual solution lies on the edge of its cones and satisfies its equations to rounding
//! only; both spoil a proof. Any `Z_k > 0` with `sum_k <F_ik, Z_k> = c_i` and a sum
//! `sum_k <F0_k, Z_k>` that is negative enough is as good. From the solver's point, shifted inside, a
//! damped Newton method finds the one with the largest product of determinants.

mod refine;

pub use refine::refined;

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use nalgebra::DMatrix;

use crate::lmi::{dual_matrix, dual_trace, inner, Cone, Entry, Semidefinite};

/// Largest number of unknowns: the equations are dense.
const MOST_UNKNOWNS: usize = 3000;

/// Shift of the start into the interior, as a fraction of the mean eigenvalue: a smaller one takes fewer steps where
/// it suffices.
const SHIFTS: [f64; 2] = [1e-4, 1e-2];

/// How many times the shift may grow tenfold where the solver's matrix is indefinite.
const SHIFT_DECADES: i32 = 12;

/// Steps at most.
const STEPS: usize = 40;

/// Steps shorter than this count as a failure.
const SHORTEST_STEP: f64 = 0.05;

/// Newton decrement, per unit of the cones' sides, at which the point is central enough.
const CENTRAL: f64 = 0.1;

/// Corrections of a step's multipliers.
const REFINEMENTS: usize = 3;

/// Steps after a central point is reached: each makes the equations hold to more digits.
const POLISHING_STEPS: usize = 4;

/// Relative part of its diagonal that is added to the matrix of the equations.
const REGULARISATION: f64 = 1e-13;

/// One cone of the equations: the row of each coefficient, and the coefficient.
struct ConeRows<'a> {
    side: usize,
    rows: Vec<(usize, &'a [Entry])>,
}

/// `sum_k <F_ik, Z_k> = c_i` for every unknown i and, last, `sum_k <F0_k, Z_k> = target`.
struct Equations<'a> {
    blocks: Vec<ConeRows<'a>>,
    right: Vec<f64>,
}

/// The centred dual solution for the given value of `sum_k <F0_k, Z_k>`, in the layout of
/// [`Solution::duals`](crate::solve::Solution::duals); `None` where it cannot be found.
pub fn centred(problem: &Semidefinite, duals: &[Vec<f64>], target: f64) -> Option<Vec<Vec<f64>>> {
    if problem.cost.len() > MOST_UNKNOWNS {
        return None;
    }
    let equations = Equations::new(problem, target);
    SHIFTS.iter().find_map(|&part| {
        let start = shifted_inside(problem, duals, part)?;
        equations.centre(start)
    })
}

/// The dual matrices with a multiple of the identity added; `None` when they are not finite.
fn shifted_inside(
    problem: &Semidefinite,
    duals: &[Vec<f64>],
    part: f64,
) -> Option<Vec<DMatrix<f64>>> {
    let sides = problem.cones.iter().map(|cone| cone.side);
    let total: usize = sides.clone().sum();
    let trace: f64 = sides
        .clone()
        .zip(duals)
        .map(|(side, dual)| dual_trace(side, dual))
        .sum();
    let shift = part * trace / total as f64;
    if !(shift > 0.0 && shift.is_finite()) {
        return None;
    }
    let full = sides.zip(duals).map(|(side, dual)| {
        let matrix = dual_matrix(side, dual);
        // Each shift makes up for a negative eigenvalue that is ten times larger.
        let shifts = (0..SHIFT_DECADES).map(|decade| shift * 10_f64.powi(decade));
        let mut shifted = shifts.map(|shift| &matrix + shift * DMatrix::identity(side, side));
        shifted.find(|shifted| shifted.clone().cholesky().is_some())
    });
    full.collect()
}

/// The largest of 1, 0.7, 0.49, ... that keeps 30 % of every distance to the edge; `None` when all
/// are too short.
fn longest_step(point: &[DMatrix<f64>], step: &[DMatrix<f64>]) -> Option<f64> {
    let keeps = |length: f64| {
        let pairs = point.iter().zip(step);
        pairs.clone().all(|(matrix, change)| {
            let reached = matrix + length * change;
            let room = match length < 1.0 {
                true => reached - 0.3 * (1.0 - length) * matrix,
                false => reached,
            };
            room.cholesky().is_some()
        })
    };
    let lengths = std::iter::successors(Some(1.0), |length| Some(0.7 * length));
    let mut tried = lengths.take_while(|length| *length > SHORTEST_STEP);
    tried.find(|length| keeps(*length))
}

impl<'a> Equations<'a> {
    fn new(problem: &'a Semidefinite, target: f64) -> Self {
        let constant = problem.cost.len();
        let block = |cone: &'a Cone| {
            let rows = cone.coefficients.iter();
            let rows = rows.map(|(unknown, entries)| (*unknown, entries.as_slice()));
            let rows = rows.chain([(constant, cone.constant.as_slice())]);
            ConeRows {
                side: cone.side,
                rows: rows.collect(),
            }
        };
        let mut right = problem.cost.clone();
        right.push(target);
        Equations {
            blocks: problem.cones.iter().map(block).collect(),
            right,
        }
    }

    /// Newton's method from a start inside the cones.
    fn centre(&self, mut point: Vec<DMatrix<f64>>) -> Option<Vec<Vec<f64>>> {
        let sides: usize = self.blocks.iter().map(|block| block.side).sum();
        let mut best = None;
        let mut polishing = 0;
        for _ in 0..STEPS {
            let Some((step, decrement)) = self.newton(&point) else {
                break;
            };
            let Some(length) = longest_step(&point, &step) else {
                break;
            };
            for (matrix, change) in point.iter_mut().zip(&step) {
                *matrix += length * change;
            }
            if length < 1.0 {
                continue;
            }
            // A full step satisfies the equations up to rounding.
            best = Some(point.clone());
            if decrement < CENTRAL * sides as f64 {
                polishing += 1;
            }
            if polishing > POLISHING_STEPS {
                break;
            }
        }
        best.map(|point| point.iter().map(upper).collect())
    }

    /// The step to the minimum of the second-order model of `-sum log det Z_k` on the equations, and
    /// the decrement.
    fn newton(&self, point: &[DMatrix<f64>]) -> Option<(Vec<DMatrix<f64>>, f64)> {
        let count = self.right.len();
        let mut matrix = Mat::<f64>::zeros(count, count);
        let mut values = vec![0.0; count];
        for (block, z) in self.blocks.iter().zip(point) {
            for (j, (column, entries)) in block.rows.iter().enumerate() {
                values[*column] += inner(entries, |r, c| z[(r, c)]);
                let image = sandwich(entries, z);
                for (row, others) in &block.rows[j..] {
                    // Rows ascend within a block.
                    matrix[(*row, *column)] += inner(others, |r, c| image[(r, c)]);
                }
            }
        }
        // Unknowns that occur nowhere have no equation.
        let scale: Vec<f64> = (0..count)
            .map(|k| match matrix[(k, k)] {
                diagonal if diagonal > 0.0 => 1.0 / diagonal.sqrt(),
                _ => 0.0,
            })
            .collect();
        for column in 0..count {
            for row in column..count {
                matrix[(row, column)] *= scale[row] * scale[column];
            }
            if scale[column] == 0.0 {
                matrix[(column, column)] = 1.0;
            }
        }
        let mut regular = matrix.clone();
        (0..count).for_each(|k| regular[(k, k)] += REGULARISATION);
        let factor = regular.llt(Side::Lower).ok()?;
        let right = Mat::from_fn(count, 1, |k, _| {
            scale[k] * (2.0 * values[k] - self.right[k])
        });
        let mut multipliers = factor.solve(&right);
        for _ in 0..REFINEMENTS {
            let remainder = &right - symmetric_product(&matrix, &multipliers);
            multipliers += factor.solve(&remainder);
        }
        let multipliers: Vec<f64> = (0..count).map(|k| scale[k] * multipliers[(k, 0)]).collect();
        if !multipliers.iter().all(|value| value.is_finite()) {
            return None;
        }
        let mut decrement = 0.0;
        let blocks = self.blocks.iter().zip(point);
        let step = blocks.map(|(block, z)| {
            let combined = block.combined(&multipliers);
            let product = &combined * z;
            let away = DMatrix::identity(block.side, block.side) - &product;
            decrement += (&away * &away).trace();
            let step = z - z * product;
            0.5 * (&step + step.transpose())
        });
        let step = step.collect();
        Some((step, decrement))
    }
}

impl ConeRows<'_> {
    /// `sum_i lambda_i F_i`.
    fn combined(&self, multipliers: &[f64]) -> DMatrix<f64> {
        let mut out = DMatrix::zeros(self.side, self.side);
        for (row, entries) in &self.rows {
            for entry in *entries {
                out[(entry.row, entry.column)] += multipliers[*row] * entry.value;
            }
        }
        out.fill_lower_triangle_with_upper_triangle();
        out
    }
}

/// The product with a symmetric matrix of which the lower triangle is given.
fn symmetric_product(lower: &Mat<f64>, vector: &Mat<f64>) -> Mat<f64> {
    let count = lower.nrows();
    let mut out = Mat::<f64>::zeros(count, 1);
    for column in 0..count {
        out[(column, 0)] += lower[(column, column)] * vector[(column, 0)];
        for row in column + 1..count {
            let entry = lower[(row, column)];
            out[(row, 0)] += entry * vector[(column, 0)];
            out[(column, 0)] += entry * vector[(row, 0)];
        }
    }
    out
}

/// `Z F Z`.
fn sandwich(entries: &[Entry], z: &DMatrix<f64>) -> DMatrix<f64> {
    let mut product = DMatrix::zeros(z.nrows(), z.ncols());
    for entry in entries {
        let (r, c) = (entry.row, entry.column);
        product.column_mut(c).axpy(entry.value, &z.column(r), 1.0);
        if r != c {
            product.column_mut(r).axpy(entry.value, &z.column(c), 1.0);
        }
    }
    product * z
}

fn upper(matrix: &DMatrix<f64>) -> Vec<f64> {
    let side = matrix.nrows();
    let columns = (0..side).flat_map(|column| (0..=column).map(move |row| (row, column)));
    columns.map(|at| matrix[at]).collect()
}
