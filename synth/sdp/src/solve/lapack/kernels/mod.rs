//! Dense kernels on matrix views, over faer.
#![forbid(unsafe_code)]

pub(super) mod blas;
pub(super) mod factor;
pub(super) mod spectral;
mod tridiagonal;

use core::mem::{size_of, MaybeUninit};

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};

/// Why a factorization or decomposition has no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    /// The pivot of this index, counted from 1, is not usable.
    Pivot(usize),
    /// The matrix holds a value that is infinite or not a number.
    NotFinite,
    /// An iteration did not end.
    NoConvergence,
    /// Scratch memory could not be allocated.
    Memory,
}

/// Number of `f64` entries that hold `request` wherever they begin.
pub fn entries(request: StackReq) -> usize {
    request
        .unaligned_bytes_required()
        .div_ceil(size_of::<f64>())
}

/// Runs `body` on the caller's workspace, or on an allocated one where that is too small.
pub fn with_stack<R>(
    request: StackReq,
    work: &mut [MaybeUninit<f64>],
    body: impl FnOnce(&mut MemStack) -> R,
) -> Result<R, Failure> {
    let stack = MemStack::new_any(work);
    if stack.can_hold(request) {
        return Ok(body(stack));
    }
    let mut buffer = MemBuffer::try_new(request).map_err(|_| Failure::Memory)?;
    Ok(body(MemStack::new(&mut buffer)))
}
