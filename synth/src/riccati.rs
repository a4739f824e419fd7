//! Riccati and Lyapunov equations by the matrix sign function.
//!
//! J. D. Roberts, "Linear model reduction and solution of the algebraic Riccati equation by use of the sign function",
//! Int. J. Control 32 (1980) 677-687; scaling by determinants: R. Byers, "Solving the algebraic Riccati equation with
//! the matrix sign function", Linear Algebra and its Applications 85 (1987) 267-279. What comes out is a candidate,
//! good or not: nothing here is relied on in a proof.

use nalgebra::{DMatrix, DVector};

/// Steps of Newton's method at most.
const STEPS: usize = 80;

/// Relative change in a step below which the iteration has converged: its next step would be exact to rounding.
const CONVERGED: f64 = 1e-9;

/// Relative residual, in units in which X is about 1, above which a solution is no candidate.
const RESIDUAL: f64 = 1e-5;

/// sign(Z) of a square matrix without eigenvalues on the imaginary axis; `None` where the iteration does not converge.
fn sign(mut z: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let side = z.nrows();
    let mut last = false;
    for _ in 0..STEPS {
        let factors = z.clone().lu();
        let u = factors.u();
        let logs: f64 = (0..side).map(|k| u[(k, k)].abs().ln()).sum();
        let inverse = factors.try_inverse()?;
        let scale = match last {
            true => 1.0,
            false => (-logs / side as f64).exp(),
        };
        if !scale.is_finite() || scale == 0.0 {
            return None;
        }
        let next = 0.5 * (scale * &z + inverse / scale);
        let change = (&next - &z).norm() / next.norm();
        z = next;
        if !change.is_finite() {
            return None;
        }
        if last && change < CONVERGED {
            return Some(z);
        }
        // Without scaling the last steps converge quadratically.
        last = last || change < 1e-2;
    }
    None
}

/// The symmetric part.
pub fn symmetric(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    0.5 * (matrix + matrix.transpose())
}

/// X of `A'X + XA - X S X + Q = 0` for which A - S X is Hurwitz: n x n, symmetric. S and Q are symmetric and may be
/// indefinite. `None` where there is none, or none that can be computed.
pub fn stabilising(a: &DMatrix<f64>, s: &DMatrix<f64>, q: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = a.nrows();
    let mut hamiltonian = DMatrix::zeros(2 * n, 2 * n);
    hamiltonian.view_mut((0, 0), (n, n)).copy_from(a);
    hamiltonian.view_mut((0, n), (n, n)).copy_from(&-s);
    hamiltonian.view_mut((n, 0), (n, n)).copy_from(&-q);
    hamiltonian
        .view_mut((n, n), (n, n))
        .copy_from(&-a.transpose());
    let z = sign(hamiltonian)?;
    // (sign(H) + I) [I; X] = 0.
    let plus = z + DMatrix::identity(2 * n, 2 * n);
    let left = plus.columns(n, n).into_owned();
    let right = -plus.columns(0, n);
    let x = left.svd(true, true).solve(&right, 0.0).ok()?;
    let x = symmetric(&x);
    let residual = a.transpose() * &x + &x * a - &x * s * &x + q;
    let size = 2.0 * a.norm() * x.norm() + x.norm() * s.norm() * x.norm() + q.norm();
    let small = residual.norm() <= RESIDUAL * size;
    let closed = a - s * &x;
    (small && x.iter().all(|entry| entry.is_finite()) && abscissa(&closed) < 0.0).then_some(x)
}

/// X of `A'X + XA + Q = 0` for a Hurwitz A: n x n, symmetric.
pub fn lyapunov(a: &DMatrix<f64>, q: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    stabilising(a, &DMatrix::zeros(a.nrows(), a.nrows()), q)
}

/// The largest real part of the eigenvalues.
pub fn abscissa(a: &DMatrix<f64>) -> f64 {
    let eigenvalues = a.complex_eigenvalues();
    let real = eigenvalues.iter().map(|value| value.re);
    real.fold(f64::NEG_INFINITY, f64::max)
}

/// The largest magnitude of the eigenvalues.
pub fn spectral_radius(a: &DMatrix<f64>) -> f64 {
    let eigenvalues = a.complex_eigenvalues();
    let size = eigenvalues.iter().map(|value| value.re.hypot(value.im));
    size.fold(0.0, f64::max)
}

/// True for a positive definite matrix, to rounding, after a congruence to unit diagonal.
pub fn positive(matrix: &DMatrix<f64>) -> bool {
    let diagonal = matrix.diagonal();
    if !diagonal
        .iter()
        .all(|&entry| entry > 0.0 && entry.is_finite())
    {
        return false;
    }
    let scale = diagonal.map(|entry| 1.0 / entry.sqrt());
    let unit = DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |r, c| {
        matrix[(r, c)] * scale[r] * scale[c]
    });
    unit.cholesky().is_some()
}

/// Sizes of states and inputs in which the entries of all A_i and of B are as alike as diagonal units can make them:
/// the least squares of their logarithms. `x = D x'`, D a diagonal of positive numbers; the units of the states
/// multiply D exactly, and a common factor of all of them is free.
pub fn balanced(vertices: &[DMatrix<f64>], input: &DMatrix<f64>) -> DVector<f64> {
    let (n, m) = input.shape();
    // Unknowns: log D of the states, log of the units of the inputs, log of the unit of time.
    let unknowns = n + m + 1;
    let mut normal = DMatrix::<f64>::zeros(unknowns, unknowns);
    let mut right = DVector::<f64>::zeros(unknowns);
    let mut entry = |from: usize, to: usize, value: f64| {
        if value == 0.0 {
            return;
        }
        // log|a| + d_from - d_to + t should be 0.
        let mut row = vec![(n + m, 1.0)];
        if from != to {
            row.extend([(from, 1.0), (to, -1.0)]);
        }
        for &(i, x) in &row {
            right[i] -= x * value.ln();
            for &(j, y) in &row {
                normal[(i, j)] += x * y;
            }
        }
    };
    for c in 0..n {
        for r in 0..n {
            let largest = vertices.iter().map(|a| a[(r, c)].abs());
            entry(c, r, largest.fold(0.0, f64::max));
        }
    }
    for s in 0..m {
        for r in 0..n {
            entry(n + s, r, input[(r, s)].abs());
        }
    }
    let solved = normal.svd(true, true).solve(&right, 1e-10);
    let logs = solved.unwrap_or_else(|_| DVector::zeros(unknowns));
    DVector::from_fn(n, |k, _| match logs[k].is_finite() {
        true => logs[k].clamp(-300.0, 300.0).exp(),
        false => 1.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scalar_riccati_equation_has_its_positive_root() {
        // 2 a x - s x^2 + q = 0.
        let one = |value| DMatrix::from_element(1, 1, value);
        for (a, s, q) in [(1.0_f64, 1.0, 1.0), (-2.0, 0.5, 3.0), (1e3, 1e-4, 1e-2)] {
            let x = stabilising(&one(a), &one(s), &one(q)).expect("a solution");
            let root = (a + (a * a + s * q).sqrt()) / s;
            assert!((x[(0, 0)] / root - 1.0).abs() < 1e-9, "{x} {root}");
        }
        // Without the imaginary axis being free there is none.
        assert!(stabilising(&one(1.0), &one(-1.0), &one(1.5)).is_none());
    }

    #[test]
    fn the_double_integrator_has_its_known_regulator() {
        let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, 0.0]);
        let s = DMatrix::from_row_slice(2, 2, &[0.0, 0.0, 0.0, 1.0]);
        let x = stabilising(&a, &s, &DMatrix::identity(2, 2)).expect("a solution");
        let root = 3.0_f64.sqrt();
        let known = DMatrix::from_row_slice(2, 2, &[root, 1.0, 1.0, root]);
        assert!((x - known).amax() < 1e-10);
    }

    #[test]
    fn balancing_undoes_a_change_of_units() {
        let a = DMatrix::from_row_slice(3, 3, &[-1.0, 2.0, 0.0, 0.5, -0.1, 1.0, 0.3, 0.0, -2.0]);
        let b = DMatrix::from_row_slice(3, 1, &[0.0, 0.0, 1.0]);
        let units = DVector::from_vec(vec![1e-6, 1e3, 1.0]);
        let restated = DMatrix::from_fn(3, 3, |r, c| a[(r, c)] * units[c] / units[r]);
        let input = DMatrix::from_fn(3, 1, |r, _| b[r] / units[r]);
        let (before, after) = (balanced(&[a], &b), balanced(&[restated], &input));
        let ratio = after.component_mul(&units).component_div(&before);
        for k in 1..3 {
            assert!((ratio[k] / ratio[0] - 1.0).abs() < 1e-6, "{ratio}");
        }
    }

    #[test]
    fn a_lyapunov_equation_is_solved() {
        let a = DMatrix::from_row_slice(2, 2, &[-1.0, 4.0, 0.0, -3.0]);
        let q = DMatrix::identity(2, 2);
        let x = lyapunov(&a, &q).expect("a Hurwitz matrix");
        assert!((a.transpose() * &x + &x * &a + q).amax() < 1e-12);
    }
}
