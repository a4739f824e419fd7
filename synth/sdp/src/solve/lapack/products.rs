//! Symbols of matrix products: `dgemm_`, `dsyrk_`, `dsyr2k_`, `dgemv_`, `dsymv_`.

use core::ffi::{c_char, c_int};

use super::arguments::{
    contained_product, illegal_argument, matrix, matrix_mut, report_illegal, transposition,
    triangle, vector, vector_mut,
};
use super::kernels::blas::{self, Part};

/// `C <- alpha op(A) op(B) + beta C`, `C` being `m` by `n` and `op(A)` `m` by `k`.
///
/// # Safety
/// The module's contract.
#[no_mangle]
pub unsafe extern "C" fn dgemm_(
    transa: *const c_char,
    transb: *const c_char,
    m: *const c_int,
    n: *const c_int,
    k: *const c_int,
    alpha: *const f64,
    a: *const f64,
    lda: *const c_int,
    b: *const f64,
    ldb: *const c_int,
    beta: *const f64,
    c: *mut f64,
    ldc: *const c_int,
) {
    // SAFETY: the module's contract; views are taken once the arguments are found legal.
    unsafe {
        let (ta, tb) = (transposition(transa), transposition(transb));
        let (m, n, k, lda, ldb, ldc) = (*m, *n, *k, *lda, *ldb, *ldc);
        let (rows_a, cols_a) = if ta == Some(true) { (k, m) } else { (m, k) };
        let (rows_b, cols_b) = if tb == Some(true) { (n, k) } else { (k, n) };
        let mut legal = [true; 13];
        (legal[0], legal[1]) = (ta.is_some(), tb.is_some());
        (legal[2], legal[3], legal[4]) = (m >= 0, n >= 0, k >= 0);
        (legal[7], legal[9], legal[12]) =
            (lda >= rows_a.max(1), ldb >= rows_b.max(1), ldc >= m.max(1));
        if let Some(position) = illegal_argument(&legal) {
            return report_illegal("dgemm", position);
        }
        if m == 0 || n == 0 {
            return;
        }
        let mut a = matrix(a, rows_a, cols_a, lda);
        let mut b = matrix(b, rows_b, cols_b, ldb);
        if ta == Some(true) {
            a = a.transpose();
        }
        if tb == Some(true) {
            b = b.transpose();
        }
        contained_product(matrix_mut(c, m, n, ldc), Part::Full, |c| {
            blas::product(*alpha, a, b, *beta, c)
        });
    }
}

/// `C <- alpha op(A) op(A)' + beta C` on one triangle of `C`, `op(A)` being `n` by `k`.
///
/// # Safety
/// The module's contract.
#[no_mangle]
pub unsafe extern "C" fn dsyrk_(
    uplo: *const c_char,
    trans: *const c_char,
    n: *const c_int,
    k: *const c_int,
    alpha: *const f64,
    a: *const f64,
    lda: *const c_int,
    beta: *const f64,
    c: *mut f64,
    ldc: *const c_int,
) {
    // SAFETY: the module's contract; views are taken once the arguments are found legal.
    unsafe {
        let (part, trans) = (triangle(uplo), transposition(trans));
        let (n, k, lda, ldc) = (*n, *k, *lda, *ldc);
        let (rows, cols) = if trans == Some(true) { (k, n) } else { (n, k) };
        let mut legal = [true; 10];
        (legal[0], legal[1]) = (part.is_some(), trans.is_some());
        (legal[2], legal[3]) = (n >= 0, k >= 0);
        (legal[6], legal[9]) = (lda >= rows.max(1), ldc >= n.max(1));
        if let Some(position) = illegal_argument(&legal) {
            return report_illegal("dsyrk", position);
        }
        let (Some(part), 1..) = (part, n) else {
            return;
        };
        let mut a = matrix(a, rows, cols, lda);
        if trans == Some(true) {
            a = a.transpose();
        }
        contained_product(matrix_mut(c, n, n, ldc), part, |c| {
            blas::rank_k_update(*alpha, a, *beta, c, part)
        });
    }
}

/// `C <- alpha (op(A) op(B)' + op(B) op(A)') + beta C` on one triangle of `C`, `op(A)` being `n` by `k`.
///
/// # Safety
/// The module's contract.
#[no_mangle]
pub unsafe extern "C" fn dsyr2k_(
    uplo: *const c_char,
    trans: *const c_char,
    n: *const c_int,
    k: *const c_int,
    alpha: *const f64,
    a: *const f64,
    lda: *const c_int,
    b: *const f64,
    ldb: *const c_int,
    beta: *const f64,
    c: *mut f64,
    ldc: *const c_int,
) {
    // SAFETY: the module's contract; views are taken once the arguments are found legal.
    unsafe {
        let (part, trans) = (triangle(uplo), transposition(trans));
        let (n, k, lda, ldb, ldc) = (*n, *k, *lda, *ldb, *ldc);
        let (rows, cols) = if trans == Some(true) { (k, n) } else { (n, k) };
        let mut legal = [true; 12];
        (legal[0], legal[1]) = (part.is_some(), trans.is_some());
        (legal[2], legal[3]) = (n >= 0, k >= 0);
        (legal[6], legal[8], legal[11]) = (lda >= rows.max(1), ldb >= rows.max(1), ldc >= n.max(1));
        if let Some(position) = illegal_argument(&legal) {
            return report_illegal("dsyr2k", position);
        }
        let (Some(part), 1..) = (part, n) else {
            return;
        };
        let mut a = matrix(a, rows, cols, lda);
        let mut b = matrix(b, rows, cols, ldb);
        if trans == Some(true) {
            (a, b) = (a.transpose(), b.transpose());
        }
        contained_product(matrix_mut(c, n, n, ldc), part, |c| {
            blas::rank_2k_update(*alpha, a, b, *beta, c, part)
        });
    }
}

/// `y <- alpha op(A) x + beta y`, `A` being `m` by `n`.
///
/// # Safety
/// The module's contract.
#[no_mangle]
pub unsafe extern "C" fn dgemv_(
    trans: *const c_char,
    m: *const c_int,
    n: *const c_int,
    alpha: *const f64,
    a: *const f64,
    lda: *const c_int,
    x: *const f64,
    incx: *const c_int,
    beta: *const f64,
    y: *mut f64,
    incy: *const c_int,
) {
    // SAFETY: the module's contract; views are taken once the arguments are found legal.
    unsafe {
        let trans = transposition(trans);
        let (m, n, lda, incx, incy) = (*m, *n, *lda, *incx, *incy);
        let mut legal = [true; 11];
        (legal[0], legal[1], legal[2]) = (trans.is_some(), m >= 0, n >= 0);
        (legal[5], legal[7], legal[10]) = (lda >= m.max(1), incx != 0, incy != 0);
        if let Some(position) = illegal_argument(&legal) {
            return report_illegal("dgemv", position);
        }
        if m == 0 || n == 0 {
            return;
        }
        let mut a = matrix(a, m, n, lda);
        if trans == Some(true) {
            a = a.transpose();
        }
        let x = vector(x, a.ncols() as c_int, incx);
        let y = vector_mut(y, a.nrows() as c_int, incy);
        contained_product(y.as_mat_mut(), Part::Full, |y| {
            blas::product_with_vector(*alpha, a, x, *beta, y.col_mut(0))
        });
    }
}

/// `y <- alpha A x + beta y` for a symmetric `A` of order `n`.
///
/// # Safety
/// The module's contract.
#[no_mangle]
pub unsafe extern "C" fn dsymv_(
    uplo: *const c_char,
    n: *const c_int,
    alpha: *const f64,
    a: *const f64,
    lda: *const c_int,
    x: *const f64,
    incx: *const c_int,
    beta: *const f64,
    y: *mut f64,
    incy: *const c_int,
) {
    // SAFETY: the module's contract; views are taken once the arguments are found legal.
    unsafe {
        let part = triangle(uplo);
        let (n, lda, incx, incy) = (*n, *lda, *incx, *incy);
        let mut legal = [true; 10];
        (legal[0], legal[1], legal[4]) = (part.is_some(), n >= 0, lda >= n.max(1));
        (legal[6], legal[9]) = (incx != 0, incy != 0);
        if let Some(position) = illegal_argument(&legal) {
            return report_illegal("dsymv", position);
        }
        let (Some(part), 1..) = (part, n) else {
            return;
        };
        let (a, x) = (matrix(a, n, n, lda), vector(x, n, incx));
        contained_product(vector_mut(y, n, incy).as_mat_mut(), Part::Full, |y| {
            blas::symmetric_product_with_vector(*alpha, a, part, x, *beta, y.col_mut(0))
        });
    }
}
