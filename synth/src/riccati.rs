//! Riccati and Lyapunov equations by the matrix sign function.
//!
//! J. D. Roberts, "Linear model reduction and solution of the algebraic Riccati equation by use of the sign function",
//! Int. J. Control 32 (1980) 677-687; scaling by determinants: R. Byers, "Solving the algebraic Riccati equation with
//! the matrix sign function", Linear Algebra and its Applications 85 (1987) 267-279. What comes out is a candidate,
//! good or not: nothing here is relied on in a proof.

use nalgebra::DMatrix;

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
    fn a_lyapunov_equation_is_solved() {
        let a = DMatrix::from_row_slice(2, 2, &[-1.0, 4.0, 0.0, -3.0]);
        let q = DMatrix::identity(2, 2);
        let x = lyapunov(&a, &q).expect("a Hurwitz matrix");
        assert!((a.transpose() * &x + &x * &a + q).amax() < 1e-12);
    }
}
