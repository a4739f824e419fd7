//! The symbols as C declares them, and a call of each on [`Padded`] matrices.
#![allow(unsafe_code)] // The symbols are called as Clarabel calls them.

use core::ffi::{c_char, c_int};

use super::matrices::Padded;

extern "C" {
    fn dgemm_(
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
    );
    fn dgemv_(
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
    );
    fn dsymv_(
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
    );
    fn dsyrk_(
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
    );
    fn dsyr2k_(
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
    );
    fn dpotrf_(
        uplo: *const c_char,
        n: *const c_int,
        a: *mut f64,
        lda: *const c_int,
        info: *mut c_int,
    );
    fn dpotrs_(
        uplo: *const c_char,
        n: *const c_int,
        nrhs: *const c_int,
        a: *const f64,
        lda: *const c_int,
        b: *mut f64,
        ldb: *const c_int,
        info: *mut c_int,
    );
    fn dgesv_(
        n: *const c_int,
        nrhs: *const c_int,
        a: *mut f64,
        lda: *const c_int,
        ipiv: *mut c_int,
        b: *mut f64,
        ldb: *const c_int,
        info: *mut c_int,
    );
    fn dsyevr_(
        jobz: *const c_char,
        range: *const c_char,
        uplo: *const c_char,
        n: *const c_int,
        a: *mut f64,
        lda: *const c_int,
        vl: *const f64,
        vu: *const f64,
        il: *const c_int,
        iu: *const c_int,
        abstol: *const f64,
        m: *mut c_int,
        w: *mut f64,
        z: *mut f64,
        ldz: *const c_int,
        isuppz: *mut c_int,
        work: *mut f64,
        lwork: *const c_int,
        iwork: *mut c_int,
        liwork: *const c_int,
        info: *mut c_int,
    );
    fn dgesdd_(
        jobz: *const c_char,
        m: *const c_int,
        n: *const c_int,
        a: *mut f64,
        lda: *const c_int,
        s: *mut f64,
        u: *mut f64,
        ldu: *const c_int,
        vt: *mut f64,
        ldvt: *const c_int,
        work: *mut f64,
        lwork: *const c_int,
        iwork: *mut c_int,
        info: *mut c_int,
    );
    fn dgesvd_(
        jobu: *const c_char,
        jobvt: *const c_char,
        m: *const c_int,
        n: *const c_int,
        a: *mut f64,
        lda: *const c_int,
        s: *mut f64,
        u: *mut f64,
        ldu: *const c_int,
        vt: *mut f64,
        ldvt: *const c_int,
        work: *mut f64,
        lwork: *const c_int,
        info: *mut c_int,
    );
}

pub fn gemm(
    trans: (u8, u8),
    k: usize,
    alpha: f64,
    a: &Padded,
    b: &Padded,
    beta: f64,
    c: &mut Padded,
) {
    let (m, n) = (c.rows(), c.cols());
    unsafe {
        dgemm_(
            &(trans.0 as c_char),
            &(trans.1 as c_char),
            &m,
            &n,
            &(k as c_int),
            &alpha,
            a.ptr(),
            &a.ld(),
            b.ptr(),
            &b.ld(),
            &beta,
            c.mut_ptr(),
            &c.ld(),
        );
    }
}

pub fn syrk(uplo: u8, trans: u8, k: usize, alpha: f64, a: &Padded, beta: f64, c: &mut Padded) {
    unsafe {
        dsyrk_(
            &(uplo as c_char),
            &(trans as c_char),
            &c.rows(),
            &(k as c_int),
            &alpha,
            a.ptr(),
            &a.ld(),
            &beta,
            c.mut_ptr(),
            &c.ld(),
        );
    }
}

pub fn syr2k(
    options: (u8, u8),
    k: usize,
    alpha: f64,
    a: &Padded,
    b: &Padded,
    beta: f64,
    c: &mut Padded,
) {
    unsafe {
        dsyr2k_(
            &(options.0 as c_char),
            &(options.1 as c_char),
            &c.rows(),
            &(k as c_int),
            &alpha,
            a.ptr(),
            &a.ld(),
            b.ptr(),
            &b.ld(),
            &beta,
            c.mut_ptr(),
            &c.ld(),
        );
    }
}

/// A vector argument: entries and stride.
pub type Strided<'a> = (&'a [f64], c_int);

pub fn gemv(trans: u8, alpha: f64, a: &Padded, x: Strided, beta: f64, y: &mut [f64], incy: c_int) {
    unsafe {
        dgemv_(
            &(trans as c_char),
            &a.rows(),
            &a.cols(),
            &alpha,
            a.ptr(),
            &a.ld(),
            x.0.as_ptr(),
            &x.1,
            &beta,
            y.as_mut_ptr(),
            &incy,
        );
    }
}

pub fn symv(uplo: u8, alpha: f64, a: &Padded, x: Strided, beta: f64, y: &mut [f64], incy: c_int) {
    unsafe {
        dsymv_(
            &(uplo as c_char),
            &a.rows(),
            &alpha,
            a.ptr(),
            &a.ld(),
            x.0.as_ptr(),
            &x.1,
            &beta,
            y.as_mut_ptr(),
            &incy,
        );
    }
}

pub fn potrf(uplo: u8, a: &mut Padded) -> c_int {
    let mut info = 99;
    unsafe {
        dpotrf_(
            &(uplo as c_char),
            &a.rows(),
            a.mut_ptr(),
            &a.ld(),
            &mut info,
        )
    };
    info
}

pub fn potrs(uplo: u8, a: &Padded, b: &mut Padded) -> c_int {
    let mut info = 99;
    unsafe {
        dpotrs_(
            &(uplo as c_char),
            &a.rows(),
            &b.cols(),
            a.ptr(),
            &a.ld(),
            b.mut_ptr(),
            &b.ld(),
            &mut info,
        );
    }
    info
}

pub fn gesv(a: &mut Padded, pivots: &mut [c_int], b: &mut Padded) -> c_int {
    let mut info = 99;
    assert_eq!(pivots.len(), a.rows);
    unsafe {
        dgesv_(
            &a.rows(),
            &b.cols(),
            a.mut_ptr(),
            &a.ld(),
            pivots.as_mut_ptr(),
            b.mut_ptr(),
            &b.ld(),
            &mut info,
        );
    }
    info
}

/// How much workspace a routine is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Workspace {
    /// What its query asks for.
    Queried,
    /// The least the reference documentation asks for.
    Least,
    /// One entry less than that.
    TooSmall,
}

impl Workspace {
    pub const LEGAL: [Workspace; 2] = [Workspace::Queried, Workspace::Least];

    fn length(self, queried: f64, least: usize) -> c_int {
        assert!(
            queried >= least as f64,
            "the query asks for less than the documentation"
        );
        match self {
            Workspace::Queried => queried as c_int,
            Workspace::Least => least as c_int,
            Workspace::TooSmall => least as c_int - 1,
        }
    }
}

pub struct Eigen {
    pub values: Vec<f64>,
    pub vectors: Padded,
    pub info: c_int,
}

/// `dsyevr_` after its workspace query.
pub fn syevr(options: [u8; 3], a: &Padded, workspace: Workspace) -> Eigen {
    let n = a.rows;
    let mut a = a.clone();
    let mut values = vec![f64::NAN; n];
    let mut vectors = Padded::unset(n, n);
    let (mut found, mut info, mut support) = (-1, 99, vec![-1; 2 * n]);
    let (mut work, mut iwork, mut lwork, mut liwork) = (vec![0.0], vec![0], -1, -1);
    let [jobz, range, uplo] = options.map(|option| option as c_char);
    for query in [true, false] {
        unsafe {
            dsyevr_(
                &jobz,
                &range,
                &uplo,
                &a.rows(),
                a.mut_ptr(),
                &a.ld(),
                &0.0,
                &0.0,
                &0,
                &0,
                &-1.0,
                &mut found,
                values.as_mut_ptr(),
                vectors.mut_ptr(),
                &vectors.ld(),
                support.as_mut_ptr(),
                work.as_mut_ptr(),
                &lwork,
                iwork.as_mut_ptr(),
                &liwork,
                &mut info,
            );
        }
        if query && info == 0 {
            lwork = workspace.length(work[0], 26 * n.max(1));
            liwork = iwork[0];
            assert!(liwork >= 10 * n.max(1) as c_int);
            work = vec![f64::NAN; lwork as usize];
            iwork = vec![-1; liwork as usize];
        } else if query {
            break;
        }
    }
    assert!(vectors.padding_is_untouched() && a.padding_is_untouched());
    if info == 0 {
        assert_eq!(found, n as c_int);
        assert!(work[0] >= 26.0 * n as f64);
    }
    Eigen {
        values,
        vectors,
        info,
    }
}

pub struct Singular {
    pub values: Vec<f64>,
    pub left: Padded,
    pub right: Padded,
    pub info: c_int,
}

/// Which of the two singular value routines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Routine {
    Gesdd,
    Gesvd,
}

/// `dgesdd_` (the two jobs being equal) or `dgesvd_` after its workspace query.
pub fn singular(routine: Routine, jobs: (u8, u8), a: &Padded, workspace: Workspace) -> Singular {
    let (m, n, short, long) = (a.rows, a.cols, a.rows.min(a.cols), a.rows.max(a.cols));
    let mut a = a.clone();
    let mut values = vec![f64::NAN; short];
    let mut left = Padded::unset(m, m);
    let mut right = Padded::unset(if jobs.1 == b'S' { short } else { n }, n);
    let least = match (routine, jobs.0) {
        (Routine::Gesvd, _) => (3 * short + long).max(5 * short),
        (_, b'N') => 3 * short + long.max(7 * short),
        (_, b'S') => 4 * short * short + 7 * short,
        _ => 4 * short * short + 6 * short + long,
    };
    let (mut work, mut iwork, mut lwork, mut info) = (vec![0.0], vec![-1; 8 * short], -1, 99);
    let (job_left, job_right) = (jobs.0 as c_char, jobs.1 as c_char);
    for query in [true, false] {
        unsafe {
            match routine {
                Routine::Gesdd => dgesdd_(
                    &job_left,
                    &a.rows(),
                    &a.cols(),
                    a.mut_ptr(),
                    &a.ld(),
                    values.as_mut_ptr(),
                    left.mut_ptr(),
                    &left.ld(),
                    right.mut_ptr(),
                    &right.ld(),
                    work.as_mut_ptr(),
                    &lwork,
                    iwork.as_mut_ptr(),
                    &mut info,
                ),
                Routine::Gesvd => dgesvd_(
                    &job_left,
                    &job_right,
                    &a.rows(),
                    &a.cols(),
                    a.mut_ptr(),
                    &a.ld(),
                    values.as_mut_ptr(),
                    left.mut_ptr(),
                    &left.ld(),
                    right.mut_ptr(),
                    &right.ld(),
                    work.as_mut_ptr(),
                    &lwork,
                    &mut info,
                ),
            }
        }
        if query && info == 0 {
            lwork = workspace.length(work[0], least.max(1));
            work = vec![f64::NAN; lwork as usize];
        } else if query {
            break;
        }
    }
    assert!(
        left.padding_is_untouched() && right.padding_is_untouched() && a.padding_is_untouched()
    );
    Singular {
        values,
        left,
        right,
        info,
    }
}
