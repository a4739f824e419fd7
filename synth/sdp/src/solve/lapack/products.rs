//! Symbols of matrix products: `dgemm_`, `dsyrk_`, `dsyr2k_`, `dgemv_`, `dsymv_`.

use core::ffi::{c_char, c_int};

use faer::MatRef;

use super::arguments::{
    contained_product, illegal_argument, letter, matrix, matrix_mut, report_illegal, transposition,
    triangle, vector, vector_mut,
};
use super::kernels::blas::{self, Part};

/// Rows and columns of the array that holds an operand which is `rows` by `cols` once transposed as asked.
fn stored(transposed: Option<bool>, rows: c_int, cols: c_int) -> (c_int, c_int) {
    match transposed {
        Some(true) => (cols, rows),
        _ => (rows, cols),
    }
}

fn transposed_if(transposed: Option<bool>, a: MatRef<'_, f64>) -> MatRef<'_, f64> {
    match transposed {
        Some(true) => a.transpose(),
        _ => a,
    }
}

/// `C <- alpha op(A) op(B) + beta C`, `C` being `m` by `n` and `op(A)` `m` by `k`.
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
        let (ta, tb) = (transposition(letter(transa)), transposition(letter(transb)));
        let (m, n, k, lda, ldb, ldc) = (*m, *n, *k, *lda, *ldb, *ldc);
        let ((rows_a, cols_a), (rows_b, cols_b)) = (stored(ta, m, k), stored(tb, k, n));
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
        let a = transposed_if(ta, matrix(a, rows_a, cols_a, lda));
        let b = transposed_if(tb, matrix(b, rows_b, cols_b, ldb));
        contained_product(matrix_mut(c, m, n, ldc), Part::Full, |c| {
            blas::product(*alpha, a, b, *beta, c)
        });
    }
}

/// `C <- alpha op(A) op(A)' + beta C` on one triangle of `C`, `op(A)` being `n` by `k`.
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
    // SAFETY: the module's contract.
    unsafe {
        let (options, size) = ((letter(uplo), letter(trans)), (*n, *k));
        rank_update(options, size, *alpha, (a, *lda), None, *beta, (c, *ldc));
    }
}

/// `C <- alpha (op(A) op(B)' + op(B) op(A)') + beta C` on one triangle of `C`, `op(A)` being `n` by `k`.
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
    // SAFETY: the module's contract.
    unsafe {
        let (options, size, b) = ((letter(uplo), letter(trans)), (*n, *k), Some((b, *ldb)));
        rank_update(options, size, *alpha, (a, *lda), b, *beta, (c, *ldc));
    }
}

/// `dsyrk_` without, `dsyr2k_` with a matrix `B`; each matrix with its leading dimension.
unsafe fn rank_update(
    (uplo, trans): (u8, u8),
    (n, k): (c_int, c_int),
    alpha: f64,
    (a, lda): (*const f64, c_int),
    b: Option<(*const f64, c_int)>,
    beta: f64,
    (c, ldc): (*mut f64, c_int),
) {
    let (part, trans) = (triangle(uplo), transposition(trans));
    let (rows, cols) = stored(trans, n, k);
    let (routine, last) = match b {
        None => ("dsyrk", 9),
        Some(_) => ("dsyr2k", 11),
    };
    let mut legal = [true; 12];
    (legal[0], legal[1]) = (part.is_some(), trans.is_some());
    (legal[2], legal[3]) = (n >= 0, k >= 0);
    legal[6] = lda >= rows.max(1);
    legal[8] = b.is_none_or(|(_, ldb)| ldb >= rows.max(1));
    legal[last] = ldc >= n.max(1);
    if let Some(position) = illegal_argument(&legal) {
        return report_illegal(routine, position);
    }
    let (Some(part), 1..) = (part, n) else {
        return;
    };
    // SAFETY: the arguments are legal, and the module's contract.
    unsafe {
        let view = |x, ld| transposed_if(trans, matrix(x, rows, cols, ld));
        let (a, b) = (view(a, lda), b.map(|(b, ldb)| view(b, ldb)));
        contained_product(matrix_mut(c, n, n, ldc), part, |c| {
            blas::rank_update(alpha, a, b, beta, c, part)
        });
    }
}

/// `y <- alpha op(A) x + beta y`, `A` being `m` by `n`.
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
        let trans = transposition(letter(trans));
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
        let a = transposed_if(trans, matrix(a, m, n, lda));
        let x = vector(x, a.ncols() as c_int, incx);
        let y = vector_mut(y, a.nrows() as c_int, incy);
        contained_product(y.as_mat_mut(), Part::Full, |y| {
            blas::product_with_vector(*alpha, a, x, *beta, y.col_mut(0))
        });
    }
}

/// `y <- alpha A x + beta y` for a symmetric `A` of order `n`.
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
        let part = triangle(letter(uplo));
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
