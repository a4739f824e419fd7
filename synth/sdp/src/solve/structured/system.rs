//! The linear system of each iteration: factored once, solved several times with refinement.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{
    cholesky_in_place, cholesky_in_place_scratch, LltRegularization,
};
use faer::{MatMut, Par};

use super::dense::{self, dot};

/// Relative residual at which refinement stops.
const REFINED: f64 = 1e-9;

/// Most steps of refinement.
const REFINEMENTS: usize = 25;

/// Shifts of the unit diagonal tried one after the other.
const SHIFTS: [f64; 7] = [0.0, 1e-14, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4];

/// A symmetric positive (semi)definite system with its Cholesky factor.
#[derive(Debug, Default)]
pub struct System {
    side: usize,
    /// The matrix, lower triangle, column-major, scaled to a unit diagonal.
    pub matrix: Vec<f64>,
    factor: Vec<f64>,
    scale: Vec<f64>,
    /// The shift of the diagonal that the factorization needed.
    pub shift: f64,
}

impl System {
    /// Scales and factors `self.matrix` (side * side, lower triangle). `false` when no shift tried makes it definite.
    #[must_use]
    pub fn factor(&mut self, side: usize) -> bool {
        self.side = side;
        let n = side;
        self.scale.clear();
        for k in 0..n {
            let diagonal = self.matrix[k * n + k];
            if !diagonal.is_finite() {
                return false;
            }
            self.scale.push(if diagonal > 0.0 {
                1.0 / diagonal.sqrt()
            } else {
                1.0
            });
        }
        for j in 0..n {
            let factor = self.scale[j];
            for i in j..n {
                self.matrix[j * n + i] *= factor * self.scale[i];
            }
        }
        SHIFTS.iter().any(|&shift| {
            self.shift = shift;
            self.try_shift(shift)
        })
    }

    fn try_shift(&mut self, shift: f64) -> bool {
        let n = self.side;
        self.factor.clear();
        self.factor.extend_from_slice(&self.matrix);
        for k in 0..n {
            self.factor[k * n + k] += shift;
        }
        let scratch = cholesky_in_place_scratch::<f64>(n, Par::Seq, Default::default());
        let Ok(mut buffer) = MemBuffer::try_new(scratch) else {
            return false;
        };
        let outcome = cholesky_in_place(
            MatMut::from_column_major_slice_mut(&mut self.factor, n, n),
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut buffer),
            Default::default(),
        );
        outcome.is_ok() && (0..n).all(|k| self.factor[k * n + k].is_finite())
    }

    /// Solves into `x`; returns the relative residual reached. Conjugate gradients, preconditioned by the
    /// factor: for an exact factor this is iterative refinement.
    pub fn solve(&self, rhs: &[f64], x: &mut [f64]) -> f64 {
        let n = self.side;
        x.fill(0.0);
        let mut r: Vec<f64> = rhs.iter().zip(&self.scale).map(|(b, s)| b * s).collect();
        let goal = dot(&r, &r).sqrt();
        if goal == 0.0 {
            return 0.0;
        }
        let mut best = f64::INFINITY;
        let mut best_x = vec![0.0; n];
        let mut trial = vec![0.0; n];
        let mut z = r.clone();
        self.precondition(&mut z);
        let mut direction = z.clone();
        let mut rz = dot(&r, &z);
        let mut product = vec![0.0; n];
        let mut worse = 0;
        for _ in 0..REFINEMENTS {
            self.multiply(&direction, &mut product);
            // A system that is only definite with a shift is solved with it: without, rounding errors would be
            // amplified along the directions that the matrix hardly sees.
            for k in 0..n {
                product[k] += self.shift * direction[k];
            }
            let curvature = dot(&direction, &product);
            if !(curvature > 0.0 && rz.is_finite()) {
                break;
            }
            let step = rz / curvature;
            for k in 0..n {
                trial[k] += step * direction[k];
                r[k] -= step * product[k];
            }
            let residual = dot(&r, &r).sqrt() / goal;
            if residual < best {
                if residual > 0.5 * best {
                    worse += 1;
                }
                best = residual;
                best_x.copy_from_slice(&trial);
            } else {
                worse += 1;
            }
            if best <= REFINED || worse > 5 {
                break;
            }
            z.copy_from_slice(&r);
            self.precondition(&mut z);
            let next = dot(&r, &z);
            let ratio = next / rz;
            rz = next;
            for k in 0..n {
                direction[k] = z[k] + ratio * direction[k];
            }
        }
        for k in 0..n {
            x[k] = best_x[k] * self.scale[k];
        }
        best
    }

    fn precondition(&self, x: &mut [f64]) {
        dense::vectorised(
            #[inline(always)]
            || {
                dense::solve_lower(&self.factor, x, self.side);
                dense::solve_lower_transposed(&self.factor, x, self.side);
            },
        );
    }

    /// `out = matrix x` from the lower triangle.
    fn multiply(&self, x: &[f64], out: &mut [f64]) {
        dense::vectorised(
            #[inline(always)]
            || dense::symmetric_product(&self.matrix, self.side, 0, x, out),
        );
    }
}
