//! Arguments of a Fortran routine, and kernels that may panic.

use core::ffi::{c_char, c_int};
use std::panic::{catch_unwind, AssertUnwindSafe};

use faer::reborrow::*;
use faer::{ColMut, ColRef, MatMut, MatRef};

use super::kernels::blas::{self, Part};
use super::kernels::Failure;

/// `info` of a kernel whose matrix is argument number `position`: 1 when it failed for another reason than its matrix.
pub(super) fn outcome_info(outcome: Option<Result<(), Failure>>, position: c_int) -> c_int {
    match outcome {
        Some(Ok(())) => 0,
        Some(Err(Failure::Pivot(index))) => index as c_int,
        Some(Err(Failure::NotFinite)) => -position,
        Some(Err(Failure::NoConvergence | Failure::Memory)) | None => 1,
    }
}

/// An option letter, in upper case.
pub(super) unsafe fn letter(option: *const c_char) -> u8 {
    // SAFETY: a scalar argument (module contract).
    (unsafe { *option } as u8).to_ascii_uppercase()
}

/// Whether an operand is transposed.
pub(super) fn transposition(letter: u8) -> Option<bool> {
    match letter {
        b'N' => Some(false),
        b'T' | b'C' => Some(true),
        _ => None,
    }
}

/// The triangle a symmetric matrix is stored in.
pub(super) fn triangle(letter: u8) -> Option<Part> {
    match letter {
        b'L' => Some(Part::Lower),
        b'U' => Some(Part::Upper),
        _ => None,
    }
}

/// The position, counted from 1, of the first argument that is not legal, as `info` reports it.
pub(super) fn illegal_argument(legal: &[bool]) -> Option<c_int> {
    legal.iter().position(|&ok| !ok).map(|at| at as c_int + 1)
}

/// Reports an illegal argument of a routine without `info`.
pub(super) fn report_illegal(routine: &str, position: c_int) {
    eprintln!("{routine}: argument {position} has an illegal value; nothing was computed");
}

/// Runs a kernel; a panic becomes `None`.
pub(super) fn contained<R>(body: impl FnOnce() -> R) -> Option<R> {
    catch_unwind(AssertUnwindSafe(body)).ok()
}

/// Runs a product into `c`; a panic fills the part of `c` with NaN.
pub(super) fn contained_product(
    mut c: MatMut<'_, f64>,
    part: Part,
    body: impl FnOnce(MatMut<'_, f64>),
) {
    if contained(|| body(c.rb_mut())).is_none() {
        blas::for_each(c, part, |entry| *entry = f64::NAN);
    }
}

pub(super) unsafe fn matrix<'a>(
    a: *const f64,
    nrows: c_int,
    ncols: c_int,
    ld: c_int,
) -> MatRef<'a, f64> {
    if nrows <= 0 || ncols <= 0 {
        return MatRef::from_column_major_slice(&[], nrows.max(0) as usize, ncols.max(0) as usize);
    }
    // SAFETY: column `j` of the array begins `j * ld` entries after `a` (module contract).
    unsafe { MatRef::from_raw_parts(a, nrows as usize, ncols as usize, 1, ld as isize) }
}

pub(super) unsafe fn matrix_mut<'a>(
    a: *mut f64,
    nrows: c_int,
    ncols: c_int,
    ld: c_int,
) -> MatMut<'a, f64> {
    // SAFETY: as in `matrix`; no output array overlaps another one (module contract).
    unsafe { MatMut::from_raw_parts_mut(a, nrows as usize, ncols as usize, 1, ld as isize) }
}

/// A vector with stride `inc`; with a negative stride its first entry is the last one in memory.
pub(super) unsafe fn vector<'a>(x: *const f64, len: c_int, inc: c_int) -> ColRef<'a, f64> {
    // SAFETY: the array holds `1 + (len - 1) |inc|` entries (module contract), `len` is positive.
    unsafe { ColRef::from_raw_parts(x.offset(first_entry(len, inc)), len as usize, inc as isize) }
}

pub(super) unsafe fn vector_mut<'a>(y: *mut f64, len: c_int, inc: c_int) -> ColMut<'a, f64> {
    // SAFETY: as in `vector`; no output array overlaps another one (module contract).
    unsafe {
        ColMut::from_raw_parts_mut(y.offset(first_entry(len, inc)), len as usize, inc as isize)
    }
}

fn first_entry(len: c_int, inc: c_int) -> isize {
    if inc < 0 {
        -(inc as isize) * (len as isize - 1)
    } else {
        0
    }
}

pub(super) unsafe fn array<'a, T>(a: *mut T, len: c_int) -> &'a mut [T] {
    if len <= 0 {
        return &mut [];
    }
    // SAFETY: the array has `len` entries and overlaps no other one (module contract).
    unsafe { core::slice::from_raw_parts_mut(a, len as usize) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_in_a_product_fills_its_part_with_nan() {
        let mut entries = [1.0; 9];
        let c = MatMut::from_column_major_slice_mut(&mut entries, 3, 3);
        contained_product(c, Part::Lower, |mut c| {
            c[(2, 0)] = 5.0;
            panic!("kernel");
        });
        let is_nan = entries.map(f64::is_nan);
        assert_eq!(
            is_nan,
            [true, true, true, false, true, true, false, false, true]
        );
    }

    #[test]
    fn a_panic_in_a_factorization_is_an_error() {
        let outcome = contained(|| -> Result<(), ()> { panic!("kernel") });
        assert_eq!(outcome, None);
    }
}
