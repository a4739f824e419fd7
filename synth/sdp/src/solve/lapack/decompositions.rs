//! Symbols of spectral decompositions: `dsyevr_`, `dgesdd_`, `dgesvd_`.

use core::ffi::{c_char, c_int};
use core::mem::MaybeUninit;

use super::arguments::{
    array, contained, illegal_argument, letter, matrix_mut, outcome_info, triangle,
};
use super::kernels::blas::Part;
use super::kernels::spectral::{self, SingularVectors, Vectors};

/// The singular vectors wanted of one side.
fn vectors(letter: u8) -> Option<Vectors> {
    match letter {
        b'N' => Some(Vectors::No),
        b'S' => Some(Vectors::Thin),
        b'A' => Some(Vectors::Full),
        _ => None,
    }
}

/// The larger of a documented workspace length and the one the kernel wants, both in entries.
fn workspace_length(documented: i64, wanted: impl FnOnce() -> usize) -> f64 {
    let wanted = contained(wanted).unwrap_or(0);
    (documented as f64).max(wanted as f64).max(1.0)
}

/// All eigenvalues of a symmetric matrix of order `n`, ascending, and with `jobz = 'V'` its eigenvectors.
#[no_mangle]
pub unsafe extern "C" fn dsyevr_(
    jobz: *const c_char,
    range: *const c_char,
    uplo: *const c_char,
    n: *const c_int,
    a: *mut f64,
    lda: *const c_int,
    _vl: *const f64,
    _vu: *const f64,
    _il: *const c_int,
    _iu: *const c_int,
    _abstol: *const f64,
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
) {
    // SAFETY: the module's contract; views are taken once the arguments are found legal.
    unsafe {
        let (job, part) = (letter(jobz), triangle(letter(uplo)));
        let (n, lda, ldz, lwork, liwork) = (*n, *lda, *ldz, *lwork, *liwork);
        let (with_vectors, query) = (job == b'V', lwork == -1 || liwork == -1);
        let (least, least_integers) = (26 * i64::from(n.max(1)), 10 * i64::from(n.max(1)));
        let mut legal = [true; 21];
        (legal[0], legal[1]) = (matches!(job, b'N' | b'V'), letter(range) == b'A');
        (legal[2], legal[3], legal[5]) = (part.is_some(), n >= 0, lda >= n.max(1));
        legal[14] = ldz >= if with_vectors { n.max(1) } else { 1 };
        legal[17] = query || i64::from(lwork) >= least;
        legal[19] = query || i64::from(liwork) >= least_integers;
        if let Some(position) = illegal_argument(&legal) {
            *info = -position;
            return;
        }
        let optimum = workspace_length(least, || {
            spectral::eigen_workspace(n as usize, with_vectors)
        });
        *info = 0;
        *work = optimum;
        *iwork = c_int::try_from(least_integers).unwrap_or(c_int::MAX);
        if query {
            return;
        }
        *m = n;
        if n == 0 {
            return;
        }
        let mut a = matrix_mut(a, n, n, lda);
        if part == Some(Part::Upper) {
            a = a.transpose_mut();
        }
        let z = with_vectors.then(|| matrix_mut(z, n, n, ldz));
        let scratch = array(work.cast::<MaybeUninit<f64>>(), lwork);
        for i in 0..n as isize * 2 * isize::from(with_vectors) {
            isuppz.offset(i).write(if i % 2 == 0 { 1 } else { n });
        }
        w.write_bytes(0, n as usize);
        let outcome = contained(|| spectral::eigen(a, array(w, n), z, scratch));
        *work = optimum;
        *info = outcome_info(outcome, 5);
    }
}

/// What `dgesdd_` and `dgesvd_` have in common: the options of both sides and the arguments after them, each array with
/// its leading dimension or length.
struct SingularRequest {
    left: Option<Vectors>,
    right: Option<Vectors>,
    /// Number of option arguments before `m`.
    options: usize,
    m: c_int,
    n: c_int,
    a: (*mut f64, c_int),
    s: *mut f64,
    u: (*mut f64, c_int),
    vt: (*mut f64, c_int),
    work: (*mut f64, c_int),
}

impl SingularRequest {
    /// The first illegal argument, where `work` must have at least `least` entries.
    fn illegal(&self, least: i64) -> Option<c_int> {
        let least_ldu = match self.left {
            None | Some(Vectors::No) => 1,
            Some(_) => self.m.max(1),
        };
        let least_ldvt = match self.right {
            None | Some(Vectors::No) => 1,
            Some(Vectors::Thin) => self.m.min(self.n).max(1),
            Some(Vectors::Full) => self.n.max(1),
        };
        let mut legal = [true; 13];
        legal[0] = self.left.is_some();
        legal[self.options - 1] &= self.right.is_some();
        let rest = &mut legal[self.options..];
        (rest[0], rest[1]) = (self.m >= 0, self.n >= 0);
        rest[3] = self.a.1 >= self.m.max(1);
        (rest[6], rest[8]) = (self.u.1 >= least_ldu, self.vt.1 >= least_ldvt);
        rest[10] = self.work.1 == -1 || i64::from(self.work.1) >= least.max(1);
        illegal_argument(&legal)
    }

    /// Checks the arguments, then answers a workspace query or decomposes; returns `info`.
    unsafe fn run(&self, least: i64) -> c_int {
        if let Some(position) = self.illegal(least) {
            return -position;
        }
        let (Some(left), Some(right)) = (self.left, self.right) else {
            return -1;
        };
        let (m, n, size) = (self.m, self.n, self.m.min(self.n));
        // SAFETY: the arguments are legal, and the module's contract.
        unsafe {
            let optimum = workspace_length(least, || {
                spectral::singular_workspace(m as usize, n as usize, left, right)
            });
            let (work, lwork) = self.work;
            *work = optimum;
            if lwork == -1 {
                return 0;
            }
            if size == 0 {
                return self.empty(left, right);
            }
            let columns = |side, full| match side {
                Vectors::No => None,
                Vectors::Thin => Some(size),
                Vectors::Full => Some(full),
            };
            let vectors = SingularVectors {
                left: columns(left, m).map(|cols| matrix_mut(self.u.0, m, cols, self.u.1)),
                right: columns(right, n)
                    .map(|rows| matrix_mut(self.vt.0, rows, n, self.vt.1).transpose_mut()),
            };
            let a = matrix_mut(self.a.0, m, n, self.a.1);
            let scratch = array(work.cast::<MaybeUninit<f64>>(), lwork);
            self.s.write_bytes(0, size as usize);
            let outcome =
                contained(|| spectral::singular(a, array(self.s, size), vectors, scratch));
            *work = optimum;
            outcome_info(outcome, self.options as c_int + 3)
        }
    }

    /// A matrix without rows or without columns: the full vectors of the other side are the unit vectors.
    unsafe fn empty(&self, left: Vectors, right: Vectors) -> c_int {
        // SAFETY: the arguments are legal, and the module's contract.
        unsafe {
            for (side, order, (vectors, ld)) in [(left, self.m, self.u), (right, self.n, self.vt)] {
                if side == Vectors::Full && order > 0 {
                    let mut identity = matrix_mut(vectors, order, order, ld);
                    identity.fill(0.0);
                    identity.diagonal_mut().fill(1.0);
                }
            }
        }
        0
    }
}

/// Singular value decomposition `A = U diag(S) VT` of an `m` by `n` matrix, singular values descending.
#[no_mangle]
pub unsafe extern "C" fn dgesdd_(
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
    _iwork: *mut c_int,
    info: *mut c_int,
) {
    // SAFETY: the module's contract.
    unsafe {
        let job = vectors(letter(jobz));
        let (m, n) = (*m, *n);
        let request = SingularRequest {
            left: job,
            right: job,
            options: 1,
            m,
            n,
            a: (a, *lda),
            s,
            u: (u, *ldu),
            vt: (vt, *ldvt),
            work: (work, *lwork),
        };
        let (short, long) = (i64::from(m.min(n)), i64::from(m.max(n)));
        let least = match job {
            None | Some(Vectors::No) => 3 * short + long.max(7 * short),
            Some(Vectors::Thin) => 4 * short * short + 7 * short,
            Some(Vectors::Full) => 4 * short * short + 6 * short + long,
        };
        *info = request.run(least);
    }
}

/// Singular value decomposition as of `dgesdd_`, with the vectors of each side chosen separately.
#[no_mangle]
pub unsafe extern "C" fn dgesvd_(
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
) {
    // SAFETY: the module's contract.
    unsafe {
        let (m, n) = (*m, *n);
        let request = SingularRequest {
            left: vectors(letter(jobu)),
            right: vectors(letter(jobvt)),
            options: 2,
            m,
            n,
            a: (a, *lda),
            s,
            u: (u, *ldu),
            vt: (vt, *ldvt),
            work: (work, *lwork),
        };
        let (short, long) = (i64::from(m.min(n)), i64::from(m.max(n)));
        *info = request.run((3 * short + long).max(5 * short));
    }
}
