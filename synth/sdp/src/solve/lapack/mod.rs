//! The BLAS and LAPACK symbols that the conic solver links against, in Rust.
//!
//! The semidefinite cones of Clarabel call BLAS and LAPACK through their Fortran symbols. This module defines
//! the ones it uses, over the dense kernels of faer, so that no system library is needed. Argument order,
//! column-major storage with a leading dimension, workspace queries and `info` follow the reference
//! documentation (Anderson et al., LAPACK Users' Guide, 3rd ed., 1999); integers are 32 bit. Deviations:
//!
//! - `dsyevr_` computes all eigenvalues only (`range = 'A'`), `dgesvd_` and `dgesdd_` have no job `'O'`;
//!   other requests are answered as illegal arguments. `abstol` is ignored.
//! - A matrix with an entry that is not finite is refused by `dsyevr_`, `dgesdd_` and `dgesvd_` with
//!   `info = -k`, `k` being the position of the matrix among the arguments. `dgesv_` stops at the first pivot
//!   that is not finite as at one that is zero.
//! - An illegal argument of a BLAS routine, which has no `info`, is written to the standard error output and
//!   the result is left as it was.
//! - Should a kernel panic, products are filled with NaN and factorizations answer with a positive `info`.
//!   Nothing unwinds into the caller.
//!
//! This is the only module of the project that is not safe Rust: `products`, `systems` and `decompositions` hold
//! the symbols, which check their arguments and take views; `kernels` computes on the views, safely.
//!
//! # Safety
//!
//! Every function trusts its caller as a Fortran library does: each scalar argument points to a valid value,
//! each array argument to as many initialized entries as the reference documentation asks for with the
//! dimensions and leading dimensions given (output-only arrays and workspaces need not be initialized),
//! and no output array overlaps another array. Arrays of size zero are never dereferenced.
#![allow(unsafe_code)]
#![allow(clippy::too_many_arguments)]
// The section above holds for every symbol.
#![allow(clippy::missing_safety_doc)]

mod arguments;
mod decompositions;
mod kernels;
mod products;
mod systems;

pub use decompositions::{dgesdd_, dgesvd_, dsyevr_};
pub use products::{dgemm_, dgemv_, dsymv_, dsyr2k_, dsyrk_};
pub use systems::{dgesv_, dpotrf_, dpotrs_};

/// Keeps the symbols in any binary that calls this, whatever the linker's order of libraries.
pub fn link() {
    core::hint::black_box([
        dgemm_ as *const (),
        dgemv_ as *const (),
        dsymv_ as *const (),
        dsyrk_ as *const (),
        dsyr2k_ as *const (),
        dpotrf_ as *const (),
        dpotrs_ as *const (),
        dgesv_ as *const (),
        dsyevr_ as *const (),
        dgesdd_ as *const (),
        dgesvd_ as *const (),
    ]);
}
