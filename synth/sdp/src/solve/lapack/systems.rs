//! Symbols of linear systems: `dpotrf_`, `dpotrs_`, `dgesv_`.

use core::ffi::{c_char, c_int};

use faer::reborrow::*;

use super::arguments::{
    array, contained, illegal_argument, letter, matrix, matrix_mut, outcome_info, triangle,
};
use super::kernels::blas::Part;
use super::kernels::factor;

/// Cholesky factor of a symmetric matrix of order `n`, in place: `L` with `A = L L'` or `U` with `A = U' U`.
///
/// `info = k`: pivot `k` is not positive.
#[no_mangle]
pub unsafe extern "C" fn dpotrf_(
    uplo: *const c_char,
    n: *const c_int,
    a: *mut f64,
    lda: *const c_int,
    info: *mut c_int,
) {
    // SAFETY: the module's contract; views are taken once the arguments are found legal.
    unsafe {
        let part = triangle(letter(uplo));
        let (n, lda) = (*n, *lda);
        let legal = [part.is_some(), n >= 0, true, lda >= n.max(1)];
        if let Some(position) = illegal_argument(&legal) {
            *info = -position;
            return;
        }
        *info = 0;
        if n == 0 {
            return;
        }
        let mut a = matrix_mut(a, n, n, lda);
        if part == Some(Part::Upper) {
            a = a.transpose_mut();
        }
        *info = outcome_info(contained(|| factor::cholesky(a)), 3);
    }
}

/// Solves `A X = B` with `nrhs` right-hand sides in place, given the factor that `dpotrf_` computed.
#[no_mangle]
pub unsafe extern "C" fn dpotrs_(
    uplo: *const c_char,
    n: *const c_int,
    nrhs: *const c_int,
    a: *const f64,
    lda: *const c_int,
    b: *mut f64,
    ldb: *const c_int,
    info: *mut c_int,
) {
    // SAFETY: the module's contract; views are taken once the arguments are found legal.
    unsafe {
        let part = triangle(letter(uplo));
        let (n, nrhs, lda, ldb) = (*n, *nrhs, *lda, *ldb);
        let mut legal = [true; 7];
        (legal[0], legal[1], legal[2]) = (part.is_some(), n >= 0, nrhs >= 0);
        (legal[4], legal[6]) = (lda >= n.max(1), ldb >= n.max(1));
        if let Some(position) = illegal_argument(&legal) {
            *info = -position;
            return;
        }
        *info = 0;
        if n == 0 || nrhs == 0 {
            return;
        }
        let (mut factor, b) = (matrix(a, n, n, lda), matrix_mut(b, n, nrhs, ldb));
        if part == Some(Part::Upper) {
            factor = factor.transpose();
        }
        let outcome = contained(|| factor::solve_with_cholesky(factor, b));
        *info = outcome_info(outcome.map(Ok), 4);
    }
}

/// Solves `A X = B` with `nrhs` right-hand sides by LU factorization, both in place.
///
/// `info = k`: pivot `k` is zero; `B` is then left as it was.
#[no_mangle]
pub unsafe extern "C" fn dgesv_(
    n: *const c_int,
    nrhs: *const c_int,
    a: *mut f64,
    lda: *const c_int,
    ipiv: *mut c_int,
    b: *mut f64,
    ldb: *const c_int,
    info: *mut c_int,
) {
    // SAFETY: the module's contract; views are taken once the arguments are found legal.
    unsafe {
        let (n, nrhs, lda, ldb) = (*n, *nrhs, *lda, *ldb);
        let (has_lda, has_ldb) = (lda >= n.max(1), ldb >= n.max(1));
        let legal = [n >= 0, nrhs >= 0, true, has_lda, true, true, has_ldb];
        if let Some(position) = illegal_argument(&legal) {
            *info = -position;
            return;
        }
        *info = 0;
        if n == 0 {
            return;
        }
        let mut a = matrix_mut(a, n, n, lda);
        for k in 0..n {
            ipiv.offset(k as isize).write(k + 1);
        }
        let pivots = array(ipiv, n);
        let outcome = contained(|| factor::lu(a.rb_mut(), pivots));
        *info = outcome_info(outcome, 3);
        if *info == 0 && nrhs > 0 {
            let b = matrix_mut(b, n, nrhs, ldb);
            let outcome = contained(|| factor::solve_with_lu(a.rb(), pivots, b));
            *info = outcome_info(outcome.map(Ok), 3);
        }
    }
}
