//! Scratch memory of the factorizations.

use core::mem::{size_of, MaybeUninit};

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};

/// Scratch memory could not be allocated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutOfMemory;

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
) -> Result<R, OutOfMemory> {
    let stack = MemStack::new_any(work);
    if stack.can_hold(request) {
        return Ok(body(stack));
    }
    let mut buffer = MemBuffer::try_new(request).map_err(|_| OutOfMemory)?;
    Ok(body(MemStack::new(&mut buffer)))
}
