//! Symmetric eigenvalue and singular value decompositions.

use core::mem::MaybeUninit;

use faer::diag::DiagMut;
use faer::dyn_stack::StackReq;
use faer::linalg::evd::{self, self_adjoint_evd, self_adjoint_evd_scratch, ComputeEigenvectors};
use faer::linalg::svd::{svd, svd_scratch};
use faer::reborrow::*;
use faer::{ColMut, MatMut, MatRef, Par};

use super::blas::{for_each, Part};
use super::{entries, tridiagonal, with_stack, Failure};

/// Which singular vectors of one side are wanted.
pub use faer::linalg::svd::ComputeSvdVectors as Vectors;

/// Largest entries in this range need no scaling.
const SAFE_RANGE: core::ops::RangeInclusive<f64> = 1e-30..=1e30;

/// Scales the part so that its largest entry is about 1 where squares and cubes of its entries could
/// underflow or overflow; gives the factor applied.
fn scale_to_safe_range(mut a: MatMut<'_, f64>, part: Part) -> Result<f64, Failure> {
    let (mut largest, mut finite) = (0.0_f64, true);
    for_each(a.rb_mut(), part, |entry| {
        finite &= entry.is_finite();
        largest = largest.max(entry.abs());
    });
    if !finite {
        return Err(Failure::NotFinite);
    }
    if largest == 0.0 || SAFE_RANGE.contains(&largest) {
        return Ok(1.0);
    }
    let factor = 1.0 / largest.max(f64::MIN_POSITIVE);
    for_each(a, part, |entry| *entry *= factor);
    Ok(factor)
}

/// Up to this order, eigenvalues without vectors are found by the kernel for small matrices.
const SMALL_ORDER: usize = 64;

fn eigen_scratch(n: usize, vectors: bool) -> StackReq {
    if !vectors && n <= SMALL_ORDER {
        return StackReq::new::<f64>(n * (n + 1));
    }
    blocked_eigen_scratch(n.max(1), vectors)
}

fn blocked_eigen_scratch(n: usize, vectors: bool) -> StackReq {
    let compute = match vectors {
        true => ComputeEigenvectors::Yes,
        false => ComputeEigenvectors::No,
    };
    self_adjoint_evd_scratch::<f64>(n, compute, Par::Seq, Default::default())
}

/// Number of workspace entries with which [`eigen`] allocates nothing.
pub fn eigen_workspace(n: usize, vectors: bool) -> usize {
    entries(eigen_scratch(n, vectors))
}

/// Eigenvalues of a symmetric matrix, ascending, and on demand its eigenvectors by columns.
///
/// Only the lower triangle is read; it may be scaled.
pub fn eigen(
    mut a: MatMut<'_, f64>,
    values: &mut [f64],
    vectors: Option<MatMut<'_, f64>>,
    work: &mut [MaybeUninit<f64>],
) -> Result<(), Failure> {
    let factor = scale_to_safe_range(a.rb_mut(), Part::Lower)?;
    let small = vectors.is_none() && a.nrows() <= SMALL_ORDER;
    if !(small && small_eigenvalues(a.rb(), values, work)?) {
        blocked_eigen(a.rb(), values, vectors, work)?;
    }
    unscale(values, factor);
    Ok(())
}

/// `false`: the iteration did not converge.
fn small_eigenvalues(
    a: MatRef<'_, f64>,
    values: &mut [f64],
    work: &mut [MaybeUninit<f64>],
) -> Result<bool, Failure> {
    let n = a.nrows();
    with_stack(eigen_scratch(n, false), work, |stack| {
        let (mut scratch, _) = stack.make_with(n * (n + 1), |_| 0.0);
        let (copy, off_diagonal) = scratch.split_at_mut(n * n);
        for j in 0..n {
            for i in j..n {
                copy[i + j * n] = a[(i, j)];
            }
        }
        tridiagonal::eigenvalues(copy, values, off_diagonal)
    })
}

fn blocked_eigen(
    a: MatRef<'_, f64>,
    values: &mut [f64],
    vectors: Option<MatMut<'_, f64>>,
    work: &mut [MaybeUninit<f64>],
) -> Result<(), Failure> {
    let scratch = blocked_eigen_scratch(a.nrows(), vectors.is_some());
    with_stack(scratch, work, |stack| {
        self_adjoint_evd(
            a,
            diagonal(values),
            vectors,
            Par::Seq,
            stack,
            Default::default(),
        )
    })?
    .map_err(|evd::EvdError::NoConvergence| Failure::NoConvergence)
}

fn singular_scratch(nrows: usize, ncols: usize, left: Vectors, right: Vectors) -> StackReq {
    svd_scratch::<f64>(nrows, ncols, left, right, Par::Seq, Default::default())
}

/// Number of workspace entries with which [`singular`] allocates nothing.
pub fn singular_workspace(nrows: usize, ncols: usize, left: Vectors, right: Vectors) -> usize {
    entries(singular_scratch(nrows, ncols, left, right))
}

/// Where the singular vectors of `A = U diag(values) V'` go, each by columns.
pub struct SingularVectors<'a> {
    pub left: Option<MatMut<'a, f64>>,
    pub right: Option<MatMut<'a, f64>>,
}

/// Singular values of a matrix, descending, and on demand its singular vectors.
///
/// The matrix may be scaled.
pub fn singular(
    mut a: MatMut<'_, f64>,
    values: &mut [f64],
    vectors: SingularVectors<'_>,
    work: &mut [MaybeUninit<f64>],
) -> Result<(), Failure> {
    let factor = scale_to_safe_range(a.rb_mut(), Part::Full)?;
    let SingularVectors {
        mut left,
        mut right,
    } = vectors;
    for side in [&mut left, &mut right].into_iter().flatten() {
        // The kernel leaves a block of full vectors unwritten where the matrix is far from square.
        side.fill(0.0);
    }
    let kind = |side: &Option<MatMut<'_, f64>>| match side {
        None => Vectors::No,
        Some(matrix) if matrix.ncols() == values.len() => Vectors::Thin,
        Some(_) => Vectors::Full,
    };
    let scratch = singular_scratch(a.nrows(), a.ncols(), kind(&left), kind(&right));
    with_stack(scratch, work, |stack| {
        svd(
            a.rb(),
            diagonal(values),
            left,
            right,
            Par::Seq,
            stack,
            Default::default(),
        )
    })?
    .map_err(|_| Failure::NoConvergence)?;
    unscale(values, factor);
    Ok(())
}

fn diagonal(values: &mut [f64]) -> DiagMut<'_, f64> {
    ColMut::from_slice_mut(values).as_diagonal_mut()
}

fn unscale(values: &mut [f64], factor: f64) {
    if factor != 1.0 {
        for value in values {
            *value /= factor;
        }
    }
}
